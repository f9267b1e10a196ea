// Asking for the state again and again. The clock and the question are injected.

/** ms between two questions. */
export const INTERVAL = 1000;

/** Asks when it is due, nothing is under way and somebody looks. */
export class Poll {
  #ask;
  #now;
  #onState;
  #onLost;
  #onSignedOut;
  #asked = -Infinity;
  #answered;
  #busy = false;
  #isOld = false; // the question under way may be answered with what was before
  #ended = false;

  /**
   * @param {object} wiring
   * @param {() => Promise<object>} wiring.ask rejects when there is no answer; with `status` 401 when nobody is signed in
   * @param {() => number} wiring.now ms
   * @param {(state: object) => void} wiring.onState
   * @param {(since: number, error: Error) => void} wiring.onLost for each failure; `since` is when the last answer came
   * @param {() => void} wiring.onSignedOut the last thing that is told
   */
  constructor({ ask, now, onState, onLost, onSignedOut }) {
    this.#ask = ask;
    this.#now = now;
    this.#onState = onState;
    this.#onLost = onLost;
    this.#onSignedOut = onSignedOut;
    this.#answered = now();
  }

  /** @param {boolean} hidden whether nobody sees the page */
  async tick(hidden) {
    if (!hidden && this.#now() - this.#asked >= INTERVAL) await this.refresh();
  }

  /** Ask now; while an older question is under way, as soon as it is answered. */
  async refresh() {
    if (this.#ended) return;
    if (this.#busy) {
      this.#isOld = true;
      return;
    }
    this.#busy = true;
    this.#isOld = false;
    this.#asked = this.#now();
    try {
      const state = await this.#ask();
      this.#answered = this.#now();
      this.#onState(state);
    } catch (error) {
      this.#ended = error.status === 401;
      if (this.#ended) this.#onSignedOut();
      else this.#onLost(this.#answered, error);
    } finally {
      this.#busy = false;
    }
    if (this.#isOld) await this.refresh();
  }
}
