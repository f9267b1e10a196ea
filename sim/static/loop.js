// One picture after the other, as long as they are wanted.

const SOON = 1000 / 120; // ms, half a picture of a screen: as much earlier than it is due a picture may come

/** Looks at each picture of the screen whether one is to be drawn; while nothing moves, it sleeps and the screen has nothing to do. */
export class Loop {
  #look;
  #draw;
  #nextPicture;
  #isAwake = false;
  #due = -Infinity; // ms

  /**
   * @param {object} wiring
   * @param {(now: number, isFirst: boolean) => void} wiring.look is called at each picture of the screen, at `now` (ms);
   *   `isFirst` after a sleep
   * @param {(now: number) => number|null} wiring.draw is called when a picture is due; returns the ms until the next, null: none
   *   before wake()
   * @param {(act: (now: number) => void) => void} [wiring.nextPicture] calls `act` when the screen is ready
   */
  constructor({ look, draw, nextPicture = (act) => requestAnimationFrame(act) }) {
    this.#look = look;
    this.#draw = draw;
    this.#nextPicture = nextPicture;
  }

  /** There is something to be drawn. */
  wake() {
    if (this.#isAwake) return;
    this.#isAwake = true;
    this.#nextPicture((now) => this.#take(now, true));
  }

  #take(now, isFirst) {
    this.#look(now, isFirst);
    if (isFirst || now >= this.#due - SOON) this.#show(now, isFirst);
    if (this.#isAwake) this.#nextPicture((next) => this.#take(next, false));
  }

  #show(now, isFirst) {
    const interval = this.#draw(now);
    this.#isAwake = interval !== null;
    // what comes late is followed the sooner, so that there are as many as are wanted; a longer delay is not made up for
    this.#due = isFirst ? now + interval : Math.max(now, this.#due + interval);
  }
}
