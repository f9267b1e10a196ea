// The own robot's camera on the stage, with the arena in its corner; and the key and the buttons that choose between them.

import { socketAddress } from "../common/addresses.js";
import { Camera } from "../camera/relay.js";
import { CameraView } from "../camera/view.js";
import { isForPage } from "../drive/controls.js";
import { isViewKey } from "../drive/keys.js";
import { ViewChoice } from "./view_choice.js";

const byId = (id) => document.getElementById(id);

export class OwnCamera {
  #robot;
  #preferences;
  #choice;
  #camera;
  #onView;
  #onPicture;
  #picture = new CameraView({ canvas: byId("camera"), note: byId("camera-note"), age: byId("camera-age") });

  /**
   * @param {object} wiring
   * @param {number} wiring.robot the player's
   * @param {import("../common/preferences_store.js").Preferences} wiring.preferences
   * @param {() => Promise<{user: string, ticket: string}|null>} wiring.getTicket for the player of this page
   * @param {(view: import("./view_choice.js").View) => void} wiring.onView what the stage shows now
   * @param {() => void} wiring.onPicture the camera's picture is drawn
   */
  constructor({ robot, preferences, getTicket, onView, onPicture }) {
    this.#robot = robot;
    this.#preferences = preferences;
    this.#onView = onView;
    this.#onPicture = onPicture;
    this.#choice = new ViewChoice(preferences.get("view"));
    this.#camera = new Camera({
      url: socketAddress("relay"),
      getTicket,
      onState: (state) => this.#take(state),
      onPicture: (bitmap, takenAt) => {
        this.#picture.draw(bitmap, takenAt);
        if (bitmap) this.#onPicture();
      },
    });
    byId("view").addEventListener("click", () => this.#toggle());
    byId("to-arena").addEventListener("click", () => this.#toggle());
    addEventListener("keydown", (event) => {
      if (isViewKey(event) && !event.repeat && !isForPage(event)) this.#toggle();
    });
  }

  start() {
    this.#camera.watch(this.#robot);
    this.#camera.start();
  }

  /** Whether the stage has a picture of the arena, too. @param {boolean} has */
  takeArena(has) {
    this.#choice.takeArena(has);
    this.#show();
  }

  stop() {
    this.#camera.stop();
  }

  #take(state) {
    this.#choice.take(state);
    if (state.state === "none") this.#picture.clear();
    else this.#picture.show(state);
    this.#show();
  }

  #toggle() {
    if (!this.#choice.canSwitch) return;
    this.#preferences.set("view", this.#choice.toggle());
    this.#show();
  }

  #show() {
    const { view, canSwitch, rests } = this.#choice;
    this.#camera.watch(rests ? null : this.#robot);
    byId("stage").dataset.view = view;
    this.#onView(view);
    byId("view").hidden = !canSwitch;
    byId("view").setAttribute("aria-pressed", String(view === "camera"));
  }
}
