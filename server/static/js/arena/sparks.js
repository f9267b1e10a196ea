// Sparks and the rising word of a hit.

import { write } from "./text.js";

const LIFE = 0.7; // s
const WORD_LIFE = 1.5 * LIFE;

export class Sparks {
  #sparks = [];
  #words = [];

  /** `robot` has been hit at `now` (s): `count` sparks and a word, which stays below `top` (m). */
  burst(robot, radius, top, count, now) {
    const above = robot.y + radius * 1.4;
    this.#words.push({ x: robot.x, y: above < top - 0.1 ? above : robot.y - radius * 2.2, born: now });
    for (let n = 0; n < count; n++) {
      const angle = Math.random() * 2 * Math.PI;
      const speed = 0.12 + 0.4 * Math.random();
      this.#sparks.push({
        x: robot.x + radius * Math.cos(angle),
        y: robot.y + radius * Math.sin(angle),
        vx: speed * Math.cos(angle),
        vy: speed * Math.sin(angle),
        born: now,
        life: LIFE * (0.4 + 0.6 * Math.random()),
      });
    }
  }

  /** Whether there is anything to draw at `now` (s). */
  isFlying(now) {
    return this.#words.some(({ born }) => now - born < WORD_LIFE) || this.#sparks.some(({ born, life }) => now - born < life);
  }

  /** Draw what is left at `now` (s), in metres, y up; `word` rises unless all is to be `still`. */
  draw(context, now, word, still) {
    this.#sparks = this.#sparks.filter(({ born, life }) => now - born < life);
    this.#words = this.#words.filter(({ born }) => now - born < WORD_LIFE);
    context.lineCap = "round";
    for (const spark of this.#sparks) drawSpark(context, spark, (now - spark.born) / spark.life);
    for (const { x, y, born } of this.#words) {
      const part = (now - born) / WORD_LIFE;
      context.fillStyle = `rgba(255, 120, 150, ${1 - part * part})`;
      write(context, word, x, y + (still ? 0 : 0.06 * part), 0.05);
    }
  }
}

function drawSpark(context, { x, y, vx, vy, life }, part) {
  const way = (1 - (1 - part) ** 2) * life * 0.5; // slowed down by the air
  const tail = 0.05 * (1 - part);
  context.strokeStyle = `rgba(255, ${Math.round(220 - 140 * part)}, ${Math.round(190 - 110 * part)}, ${1 - part})`;
  context.lineWidth = 0.005 * (1 - 0.6 * part);
  context.beginPath();
  context.moveTo(x + vx * way, y + vy * way);
  context.lineTo(x + vx * (way - tail), y + vy * (way - tail));
  context.stroke();
}
