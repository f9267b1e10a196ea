// The real floor from straight above, live: what the camera above it sees, laid flat. Nothing is fetched while nobody looks.

import { STALE } from "../camera/age.js";
import { ABOVE } from "../camera/picture.js";
import { Camera } from "../camera/relay.js";
import { flatten, rectify } from "./rectify.js";
import { readSight } from "./sight.js";

const PACE = 200; // ms between two pictures
const LOOK = 250; // ms between two looks at the picture's age
const WAIT = 3; // s from the beginning until it is said that there is no picture

/** @typedef {"none"|"off"|"waiting"|"live"|"away"} FloorState "none": no such camera is known; "away": no picture, or only old ones */

const browser = {
  camera: (wiring) => new Camera(wiring),
  canvas: (width, height) => new OffscreenCanvas(width, height),
  now: () => performance.now() / 1000,
  every(ms, act) {
    const timer = setInterval(act, ms);
    return () => clearInterval(timer);
  },
};

export class FloorPicture {
  #onPicture;
  #onState;
  #atTags;
  #world;
  #camera;
  #sight = null;
  #isKnown = false; // that there is such a camera
  #frame = null;
  #flat = null; // for this sight and frame
  #isLive = false; // the relay has its pictures
  #lookedAt = null; // since when somebody looks, s
  #takenAt = null; // of the picture that is shown, s
  #picture = null; // the camera's, to be read
  #shown = null; // the flat one
  #stopLooking = () => {};
  #view = "off"; // the state, if there is such a camera
  /** @type {FloorState} */
  state = "none";

  /**
   * @param {object} wiring
   * @param {string} wiring.url of the cameras' relay
   * @param {(picture: OffscreenCanvas|null) => void} wiring.onPicture a new picture of the `frame`, to be drawn at once; null: the
   *   last one is not true any more
   * @param {(state: FloorState) => void} [wiring.onState] on each change
   * @param {"tags"|"floor"} [wiring.level] what lies at its place: robots by their tags, or the floor itself
   * @param {() => Promise<{user?: string, ticket: string}|null>} [wiring.getTicket] says whose page this is
   * @param {object} world the camera's connection, canvases and time; tests have their own
   */
  constructor({ url, onPicture, onState = () => {}, level = "tags", getTicket }, world = browser) {
    this.#onPicture = onPicture;
    this.#onState = onState;
    this.#atTags = level === "tags";
    this.#world = world;
    this.#camera = world.camera({
      url,
      getTicket,
      pace: PACE,
      onState: ({ state }) => this.#hear(state),
      onPicture: (bitmap, takenAt) => this.#take(bitmap, takenAt),
    });
    this.#camera.watch(ABOVE);
  }

  /** What the page's connection to rosbridge is to bring. @type {import("../drive/connection.js").Topic[]} */
  topics = [{ topic: "/overhead/view", type: "laser_bot_battle/OverheadView", take: (message) => this.#see(message) }];

  /** What the picture is to show of the floor. @param {import("./rectify.js").Frame} frame */
  set frame(frame) {
    this.#frame = frame;
    this.#renew();
  }

  /** Look, or do not: then nothing is fetched. @param {boolean} looks */
  look(looks) {
    if (looks === (this.#view !== "off")) return;
    if (looks) {
      this.#lookedAt = this.#world.now();
      this.#camera.start();
      this.#stopLooking = this.#world.every(LOOK, () => this.#age());
    } else {
      this.#camera.stop();
      this.#stopLooking();
      this.#isLive = false;
      this.#forget();
    }
    this.#become(looks ? "waiting" : "off");
  }

  #see(message) {
    this.#isKnown = true;
    this.#sight = readSight(message);
    this.#renew();
    this.#become(this.#view);
  }

  /** What was made for another sight or frame is of no use. */
  #renew() {
    this.#flat = null;
    if (this.#sight === null) this.#away();
  }

  #hear(state) {
    this.#isLive = state === "live";
    if (!this.#isLive) this.#away();
  }

  /** @returns {boolean} whether it is shown; `bitmap` null: it looks like the one before */
  #take(bitmap, takenAt) {
    const sight = this.#sight;
    if (!this.#isLive || !sight || !this.#frame) return false;
    if (this.#world.now() - takenAt >= STALE) return false;
    if (bitmap === null) {
      if (this.#flat === null || this.#takenAt === null) return false;
    } else {
      if (bitmap.width !== sight.width || bitmap.height !== sight.height) return false; // the tracker has not measured it yet
      this.#flat ??= flatten(sight, this.#frame, this.#atTags ? sight.tagHeight : 0);
      this.#onPicture(this.#lay(bitmap));
    }
    this.#takenAt = takenAt;
    this.#become("live");
    return true;
  }

  #lay(bitmap) {
    const { width, height } = bitmap;
    const flat = this.#flat;
    this.#picture = this.#sized(this.#picture, width, height);
    this.#shown = this.#sized(this.#shown, flat.width, flat.height);
    const from = this.#picture.getContext("2d", { alpha: false, willReadFrequently: true });
    from.drawImage(bitmap, 0, 0);
    const to = this.#shown.getContext("2d");
    const image = to.createImageData(flat.width, flat.height);
    rectify(new Uint32Array(from.getImageData(0, 0, width, height).data.buffer), flat, new Uint32Array(image.data.buffer));
    to.putImageData(image, 0, 0);
    return this.#shown;
  }

  #sized(canvas, width, height) {
    return canvas?.width === width && canvas.height === height ? canvas : this.#world.canvas(width, height);
  }

  #age() {
    const now = this.#world.now();
    if (this.#takenAt === null ? now - this.#lookedAt >= WAIT : now - this.#takenAt >= STALE) this.#away();
  }

  #away() {
    if (this.#view === "off") return;
    this.#forget();
    this.#become("away");
  }

  #forget() {
    if (this.#takenAt === null) return;
    this.#takenAt = null;
    this.#onPicture(null);
  }

  #become(view) {
    this.#view = view;
    const news = this.#isKnown ? view : "none";
    if (news === this.state) return;
    this.state = news;
    this.#onState(news);
  }
}
