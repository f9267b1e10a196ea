// How far the relay's clock is from this page's, told by when its pictures get here. Pure; the relay does the same with a
// robot's clock (server/camera/clock.py).

const WINDOW = 30; // s; a sample counts for one to two of them, as clocks drift, and the way to the relay changes
const JUMP = 10; // s; no picture is so late: a clock has been set, or this computer has slept

/** This page's clock minus the relay's, as far as the shortest way of a picture tells. All times are in s. */
export class ClockOffset {
  #offset = Infinity; // the smallest sample of this window,
  #before = Infinity; // and that of the window before
  #began = -Infinity;

  /** A picture was sent at `sent` by the relay's clock, and is here at `received` by the page's. @returns {number} the offset known now */
  sample(sent, received) {
    const offset = received - sent;
    if (offset - Math.min(this.#offset, this.#before) > JUMP) this.#offset = this.#before = Infinity;
    if (received - this.#began >= WINDOW) {
      this.#before = received - this.#began < 2 * WINDOW ? this.#offset : Infinity;
      this.#offset = Infinity;
      this.#began = received;
    }
    this.#offset = Math.min(this.#offset, offset);
    return Math.min(this.#offset, this.#before);
  }
}
