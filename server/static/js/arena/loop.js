// One picture after the other, as long as they are wanted.

const SOON = 1000 / 120; // ms, half a picture of a screen: as much earlier than it is due a picture may come
const LONG = 24; // ms until the next one; the screen, which would have to get every picture in between ready, is left alone
const AHEAD = 12; // ms before a picture is due, the screen is asked for it

/** Draws as often as it is wanted; in between, and while nothing moves, it sleeps and the screen has nothing to do. */
export class Loop {
  #look;
  #draw;
  #nextPicture;
  #later;
  #isAwake = false;
  #due = -Infinity; // ms

  /**
   * @param {object} wiring
   * @param {(now: number, isFirst: boolean, waited: number) => void} wiring.look is called at each picture of the screen that was
   *   asked for, at `now` (ms), `waited` ms after that; `isFirst` after a sleep
   * @param {(now: number) => number|null} wiring.draw is called when a picture is due; returns the ms until the next, null: none
   *   before wake()
   * @param {(act: (now: number) => void) => void} [wiring.nextPicture] calls `act` when the screen is ready
   * @param {(act: () => void, ms: number) => void} [wiring.later] calls `act` after so long
   */
  constructor({ look, draw, nextPicture = (act) => requestAnimationFrame(act), later = (act, ms) => setTimeout(act, ms) }) {
    this.#look = look;
    this.#draw = draw;
    this.#nextPicture = nextPicture;
    this.#later = later;
  }

  /** There is something to be drawn. */
  wake() {
    if (this.#isAwake) return;
    this.#isAwake = true;
    this.#nextPicture((now) => this.#take(now, true, 0));
  }

  #take(now, isFirst, waited) {
    this.#look(now, isFirst, waited);
    if (isFirst || now >= this.#due - SOON) this.#show(now, isFirst);
    if (!this.#isAwake) return;
    const pause = this.#due - now > LONG ? this.#due - now - AHEAD : 0;
    const ask = () => this.#nextPicture((next) => this.#take(next, false, next - now - pause));
    if (pause) this.#later(ask, pause);
    else ask();
  }

  #show(now, isFirst) {
    const interval = this.#draw(now);
    this.#isAwake = interval !== null;
    // what comes late is followed the sooner, so that there are as many as are wanted; a longer delay is not made up for
    this.#due = isFirst ? now + interval : Math.max(now, this.#due + interval);
  }
}
