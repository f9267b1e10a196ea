// A camera's picture on a page: the newest one, how old it is, and why there is none.

import { ageOf } from "./age.js";
import { enlargement } from "./enlargement.js";
import { hasGpu } from "../arena/rendering.js";
import { cameraText } from "./words.js";
import { setText } from "../common/dom.js";
import { t } from "../common/words.js";

const TICK = 250; // ms between two looks at the picture's age

/** Draws in `canvas`, which is hidden until there is a picture; css/camera.css greys it by `data-level`. */
export class CameraView {
  #canvas;
  #note;
  #age;
  #context;
  #hasGpu = hasGpu();
  #shown = 0; // how wide the canvas is on the screen, in its pixels
  #takenAt = null; // of the picture that is shown, s of performance.now() / 1000
  #state = null;

  /**
   * @param {object} parts
   * @param {HTMLCanvasElement} parts.canvas
   * @param {HTMLElement} parts.note says why there is no new picture
   * @param {HTMLElement} parts.age says how old the picture is, where that is to be noticed
   */
  constructor({ canvas, note, age }) {
    this.#canvas = canvas;
    this.#note = note;
    this.#age = age;
    this.#context = canvas.getContext("2d", { alpha: false });
    setInterval(() => this.#look(), TICK);
    new ResizeObserver(([{ contentRect }]) => (this.#shown = contentRect.width * devicePixelRatio)).observe(canvas);
  }

  /** A picture that was taken at `takenAt`, in s of performance.now() / 1000; null looks like the one before. */
  draw(bitmap, takenAt) {
    if (bitmap) this.#paint(bitmap);
    this.#takenAt = takenAt;
    this.#canvas.hidden = false;
    if (this.#canvas.dataset.level !== "fresh") this.#look();
  }

  #paint(bitmap) {
    const times = this.#hasGpu ? 1 : enlargement(bitmap.width, this.#shown);
    const [width, height] = [times * bitmap.width, times * bitmap.height];
    if (this.#canvas.width !== width || this.#canvas.height !== height) Object.assign(this.#canvas, { width, height });
    this.#canvas.classList.toggle("is-enlarged", times > 1);
    this.#context.drawImage(bitmap, 0, 0, width, height);
  }

  /** What the relay says of the camera. @param {import("./relay.js").CameraState} state */
  show(state) {
    this.#state = state;
    if (state.state === "none" || state.state === "refused") this.#forget();
    this.#look();
  }

  /** No camera is looked through any more. */
  clear() {
    this.#state = null;
    this.#forget();
    this.#look();
  }

  #forget() {
    this.#takenAt = null;
    this.#canvas.hidden = true;
  }

  #look() {
    const { level, text } = this.#takenAt === null ? ageOf(0) : ageOf(performance.now() / 1000 - this.#takenAt);
    const isLive = this.#state?.state === "live";
    this.#canvas.dataset.level = isLive ? level : "stale";
    const why = this.#state ? cameraText(this.#state) || (level === "stale" ? t("camera.stale") : "") : "";
    show(this.#note, why);
    show(this.#age, isLive ? text : "");
  }
}

function show(node, text) {
  node.hidden = text === "";
  setText(node, text);
}
