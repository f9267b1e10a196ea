// How good the way to rosbridge and back is. Pure.

const GOOD = 80; // ms: a player does not feel it
const FAIR = 200; // ms: it is felt, but one can drive
const KEPT = 5; // measurements, about 10 s

/** The way of the last measurements, in ms: their middle, so that a single late one does not alarm. */
export class LinkQuality {
  #times = [];

  /** @param {number} ms a round trip, or how long an answer is awaited already */
  add(ms) {
    this.#times = [...this.#times, ms].slice(-KEPT);
  }

  /** After a connection was lost, old times say nothing. */
  clear() {
    this.#times = [];
  }

  /** @returns {{ms: number, level: "good"|"fair"|"poor"}|null} null: not measured yet */
  get value() {
    if (this.#times.length === 0) return null;
    const ms = Math.round(this.#times.toSorted((one, other) => one - other)[this.#times.length >> 1]);
    return { ms, level: ms < GOOD ? "good" : ms < FAIR ? "fair" : "poor" };
  }
}
