// What a spectator looks at: the arena, or through one robot's camera. The address keeps the choice, as #robot3: a screen that
// is loaded again shows the same.

import { socketAddress } from "../common/addresses.js";
import { Camera } from "../camera/relay.js";
import { CameraView } from "../camera/view.js";
import { element } from "../common/dom.js";
import { t } from "../common/words.js";

const byId = (id) => document.getElementById(id);

/** @param {string} hash of an address @returns {number|null} the robot that it names */
export function robotOf(hash) {
  const found = /^#robot(\d{1,3})$/.exec(hash);
  return found ? Number(found[1]) : null;
}

/**
 * What there is to be chosen: each player's robot, and the one that is chosen already.
 * @param {{name: string, robot: number}[]} users @param {number|null} chosen
 * @returns {{robot: number, name: string}[]} by robot; an empty name: nobody drives it
 */
export function camerasOf(users, chosen) {
  const found = users.map(({ name, robot }) => ({ robot, name }));
  if (chosen !== null && !found.some(({ robot }) => robot === chosen)) found.push({ robot: chosen, name: "" });
  return found.sort((one, other) => one.robot - other.robot);
}

/** The choice in #view-choice, and the camera in #camera. */
export class ViewChoice {
  #hasArena = true; // until it is known that there is none
  #robot = null;
  #users = [];
  #offered = ""; // what the choice is made of
  #picture = null; // made when a camera is chosen for the first time, as the connection is
  #camera = null;

  constructor() {
    const choice = byId("view-choice");
    choice.addEventListener("change", () => {
      history.replaceState(null, "", choice.value === "" ? location.pathname : `#robot${choice.value}`);
      this.#choose(robotOf(location.hash));
    });
    addEventListener("hashchange", () => this.#choose(robotOf(location.hash)));
    this.#choose(robotOf(location.hash));
  }

  /** Whether the stage has a picture of the arena. @param {boolean} has */
  takeArena(has) {
    this.#hasArena = has;
    this.#offer();
    this.#lay();
  }

  /** Who plays now. @param {{name: string, robot: number}[]} users */
  take(users) {
    this.#users = users;
    this.#offer();
  }

  #choose(robot) {
    this.#robot = robot;
    this.#offer();
    this.#lay();
    this.#picture?.clear();
    if (robot !== null && !this.#camera) this.#open();
    this.#camera?.watch(robot);
  }

  #lay() {
    byId("stage").dataset.view = this.#robot === null ? "arena" : "camera";
    document.body.dataset.arena = this.#hasArena || this.#robot !== null ? "yes" : "no";
  }

  #open() {
    this.#picture = new CameraView({ canvas: byId("camera"), note: byId("camera-note"), age: byId("camera-age") });
    this.#camera = new Camera({
      url: socketAddress("relay"),
      onState: (state) => this.#picture.show(state),
      onPicture: (bitmap, takenAt) => this.#picture.draw(bitmap, takenAt),
    });
    this.#camera.start();
  }

  #offer() {
    const cameras = camerasOf(this.#users, this.#robot);
    const choice = byId("view-choice");
    const offered = JSON.stringify([cameras, this.#hasArena]);
    if (offered !== this.#offered) {
      this.#offered = offered;
      choice.replaceChildren(
        element("option", { value: "" }, t(this.#hasArena ? "watch.view_arena" : "watch.view_none")),
        ...cameras.map(({ robot, name }) => element("option", { value: String(robot) }, cameraText(robot, name))),
      );
    }
    choice.value = this.#robot === null ? "" : String(this.#robot);
  }
}

const cameraText = (robot, name) => (name ? t("watch.view_of", { n: String(robot), name }) : t("watch.view_robot", { n: String(robot) }));
