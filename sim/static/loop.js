// One picture after the other, as long as they are wanted.

import { isSoon, waitFor } from "./pace.js";

const browser = {
  nextPicture: (act) => requestAnimationFrame(act),
  later: (ms, act) => setTimeout(act, ms),
  now: () => performance.now(),
};

/** Asks the screen for pictures, no more of them than are wanted, and for none at all while it sleeps. */
export class Loop {
  #picture;
  #world;
  #isAwake = false;

  /**
   * @param {(now: number, interval: number|null) => number|null} picture is called when the screen is ready for one, at `now`
   *   (ms), `interval` after the one before (null: the first after a sleep), and returns the ms until the next; null: none
   *   before wake()
   * @param {object} world the screen and timers; tests have their own
   */
  constructor(picture, world = browser) {
    this.#picture = picture;
    this.#world = world;
  }

  /** There is something to be drawn. */
  wake() {
    if (this.#isAwake) return;
    this.#isAwake = true;
    this.#ask(0, null);
  }

  /** The picture that comes `interval` ms after that of `last` (ms). */
  #ask(last, interval) {
    const wait = interval === null ? 0 : last + waitFor(interval) - this.#world.now(); // drawing takes its time, too
    const take = (now) => {
      if (interval !== null && isSoon(now - last, interval)) ask();
      else this.#take(now, interval);
    };
    const ask = () => this.#world.nextPicture(take);
    if (wait > 0) this.#world.later(wait, ask);
    else ask();
  }

  #take(now, interval) {
    const next = this.#picture(now, interval);
    this.#isAwake = next !== null;
    if (this.#isAwake) this.#ask(now, next);
  }
}
