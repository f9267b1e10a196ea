// One picture of the screen for two of the page: whatever is drawn beside the arena, the arena is drawn with it. What the
// screen shows anew at once is one rectangle, so that two small pictures in two corners cost as much as the whole page.

const GONE = 150; // ms without a picture beside it, after which it is drawn alone

/** When the screen is asked for the arena's next picture. */
export class Company {
  #act = null; // what waits for the next picture beside it
  #seenAt = -Infinity; // ms
  #now;
  #nextPicture;
  #later;

  /**
   * @param {() => number} [now] ms
   * @param {(act: (now: number) => void) => void} [nextPicture] calls `act` when the screen is ready
   * @param {(act: () => void, ms: number) => void} [later] calls `act` after so long
   */
  constructor(now = () => performance.now(), nextPicture = (act) => requestAnimationFrame(act), later = (act, ms) => setTimeout(act, ms)) {
    this.#now = now;
    this.#nextPicture = nextPicture;
    this.#later = later;
  }

  /** Whether pictures are drawn beside the arena's. */
  get isThere() {
    return this.#now() - this.#seenAt < GONE;
  }

  /** One is being drawn. */
  join() {
    this.#seenAt = this.#now();
    this.#go();
  }

  /** Call `act` when the screen is ready; where there is company, with its next picture. */
  next(act) {
    if (!this.isThere) {
      this.#nextPicture(act);
      return;
    }
    this.#act = act;
    this.#later(() => this.#act === act && this.#go(), GONE);
  }

  #go() {
    if (!this.#act) return;
    const act = this.#act;
    this.#act = null;
    this.#nextPicture(act);
  }
}
