// The floor on a canvas: draws what moves, as often as it can be seen. Whoever has robots gives it them.

import { Company } from "./company.js";
import { Governor } from "./governor.js";
import { Loop } from "./loop.js";
import { MOTION, REST } from "./pace.js";
import { hasGpu } from "./rendering.js";
import { Roles } from "./roles.js";
import { Scene } from "./scene.js";

const SETTLING = 0.5; // s after the last news until the picture, which is a bit behind, shows it
const BY_SOFTWARE = 30; // pictures a second where the computer's processor draws, which the page and the robots need, too

const calm = matchMedia("(prefers-reduced-motion: reduce)");

export class Picture {
  #scene;
  #robots;
  #governor = new Governor();
  #company = new Company();
  #loop = new Loop({
    look: (...seen) => this.#look(...seen),
    draw: (now) => this.#draw(now),
    nextPicture: (act) => this.#company.next(act),
  });
  #most = hasGpu() ? MOTION : BY_SOFTWARE; // pictures a second
  #newsAt = 0; // s
  #scale = 1;
  #players = ""; // as text
  #places = ""; // as text

  /**
   * @param {HTMLCanvasElement} canvas fills its parent
   * @param {(now: number) => object[]} robots that are to be seen at `now` (s)
   * @param {{you: string, hit: string}} words in the picture
   */
  constructor(canvas, robots, words) {
    this.#scene = new Scene(canvas);
    this.#robots = robots;
    this.roles = new Roles(words);
    new ResizeObserver(([{ contentRect }]) => {
      this.#scene.resize(contentRect.width, contentRect.height);
      this.wake();
    }).observe(canvas.parentElement);
  }

  /** Another floor. @param {import("./positions.js").Floor} floor */
  build(floor) {
    this.#scene.build(floor);
    this.wake();
  }

  /** What is under the robots instead of the drawn floor; null: nothing. @param {OffscreenCanvas|null} picture */
  set realFloor(picture) {
    this.#scene.realFloor = picture;
    this.#loop.wake();
  }

  /** Hills, and what lies on the floor. @param {import("../battle/messages.js").Place[]} places */
  set places(places) {
    const news = JSON.stringify(places);
    if (news === this.#places) return;
    this.#places = news;
    this.#scene.places = places;
    this.wake();
  }

  /** Who plays. @param {import("./roles.js").Players} players */
  show(players) {
    const news = JSON.stringify(players);
    if (news === this.#players) return;
    this.#players = news;
    this.roles.take(players, seconds());
    this.#scene.renew();
    this.wake();
  }

  /** At how much of its size the page shows the picture, by a transform: a small one has fewer pixels, and slower motion, which is drawn
   *  less often. @param {number} scale */
  set scale(scale) {
    if (scale === this.#scale) return;
    this.#scale = this.#scene.share = scale;
    this.wake();
  }

  /** Another picture is being drawn beside this one. */
  join() {
    this.#company.join();
  }

  /** Something may look other now. */
  wake() {
    this.#newsAt = seconds();
    this.#loop.wake();
  }

  #look(now, isFirst, waited) {
    if (isFirst || this.#company.isThere) this.#governor.rest(); // it did not wait for the screen alone
    this.#governor.picture(now, waited);
  }

  /** A picture is due at `now` (ms). @returns {number|null} ms until the next, null before there is news */
  #draw(now) {
    const { effects } = this.#governor;
    const time = now / 1000;
    const pace = this.#scene.show(this.#robots(time), this.roles, effects, calm.matches, time);
    const wanted = Math.min(this.#most * this.#scale, effects.pictures, time - this.#newsAt < SETTLING ? MOTION : pace);
    return wanted === REST ? null : 1000 / wanted;
  }
}

const seconds = () => performance.now() / 1000;
