// The parts of robots, painted once for each size of the picture and then copied.

import { paintRays, paintShield, REACH } from "./effects.js";
import { paintBody, paintHalo, paintOutline, paintPuff, paintShadow, paintWheel, WHEEL } from "./robot.js";
import { write } from "./text.js";

const TREADS = 6; // pictures of a rolling wheel until it looks as before

export class Sprites {
  #made = new Map();
  #scale;
  #radius;

  /**
   * @param {number} scale pixels of the canvas for a metre
   * @param {number} radius of a robot (m)
   */
  constructor(scale, radius) {
    this.#scale = scale;
    this.#radius = radius;
  }

  shadow() {
    return this.#sprite("shadow", 1.25 * this.#radius, (context) => paintShadow(context, this.#radius));
  }

  body(colour, lamp, flash) {
    const paint = (context) => paintBody(context, this.#radius, colour, lamp, flash);
    return this.#sprite(`body ${colour} ${lamp} ${flash}`, 1.2 * this.#radius, paint);
  }

  /** Of a robot that is covered. */
  outline(colour) {
    return this.#sprite(`outline ${colour}`, 1.2 * this.#radius, (context) => paintOutline(context, this.#radius, colour));
  }

  /** Around a robot whom no hit harms. */
  shield() {
    return this.#sprite("shield", REACH * this.#radius, (context) => paintShield(context, this.#radius));
  }

  /** Around a robot that hits twice as hard. */
  rays() {
    return this.#sprite("rays", REACH * this.#radius, (context) => paintRays(context, this.#radius));
  }

  /** A wheel that has rolled so far (m). */
  wheel(rolled) {
    const phase = Math.floor((((rolled / WHEEL.tread) % 1) + 1) * TREADS) % TREADS;
    const paint = (context) => paintWheel(context, (phase / TREADS) * WHEEL.tread);
    return this.#sprite(`wheel ${phase}`, WHEEL.length / 2 + 0.004, paint);
  }

  number(text) {
    return this.#sprite(`number ${text}`, 0.6 * this.#radius, (context) => {
      context.fillStyle = "#eaf2ff";
      write(context, text, 0, 0, this.#radius * 0.74);
    });
  }

  halo() {
    return this.#sprite("halo", 2 * this.#radius, (context) => paintHalo(context, this.#radius));
  }

  puff() {
    return this.#sprite("puff", this.#radius, (context) => paintPuff(context, this.#radius));
  }

  /** A square picture whose middle is the origin, `reach` m from it to each side. */
  #sprite(key, reach, paint) {
    let sprite = this.#made.get(key);
    if (!sprite) {
      const half = Math.ceil(reach * this.#scale);
      const canvas = new OffscreenCanvas(2 * half, 2 * half);
      const context = canvas.getContext("2d");
      context.setTransform(this.#scale, 0, 0, -this.#scale, half, half);
      paint(context);
      sprite = canvas.transferToImageBitmap(); // copied faster than a canvas, which may change
      this.#made.set(key, sprite);
    }
    return sprite;
  }
}
