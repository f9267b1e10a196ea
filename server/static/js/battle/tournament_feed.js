// The tournament for a page: asked for when the status tells that it has changed. Pure but for what it asks with.

const AGAIN = 1000; // ms; what has just been decided is in the database a moment later
const MOST_AGAIN = 16_000; // ms; each further time takes twice as long

const browser = {
  async ask() {
    const response = await fetch("/tournament.json", { signal: AbortSignal.timeout(4000) });
    if (!response.ok) throw new Error(`/tournament.json: ${response.status}`);
    return (await response.json()).tournament;
  },
  later: (ms, act) => setTimeout(act, ms),
  random: Math.random,
};

export class TournamentFeed {
  #onChange;
  #world;
  #wanted = 0; // version in the status; 0: none is open
  #known = 0;
  #asking = false;
  #failures = 0;

  /** @param {(tournament: object|null) => void} onChange with what /tournament.json has; null: none is open */
  constructor(onChange, world = browser) {
    this.#onChange = onChange;
    this.#world = world;
  }

  /** @param {{tournament: number}} status */
  take({ tournament: version }) {
    if (version === this.#wanted) return;
    this.#wanted = version;
    if (version === 0) this.#end();
    else this.#ask();
  }

  #end() {
    this.#known = 0;
    this.#onChange(null);
  }

  async #ask() {
    if (this.#asking) return;
    this.#asking = true;
    const found = await this.#world.ask().catch(() => null);
    this.#asking = false;
    if (this.#wanted === 0) return;
    if (found && found.version !== this.#known && found.open) {
      this.#known = found.version;
      this.#onChange(found);
    }
    if (found && found.version >= this.#wanted) {
      this.#failures = 0;
      return;
    }
    const wait = Math.min(MOST_AGAIN, AGAIN * 2 ** this.#failures);
    this.#failures += 1;
    this.#world.later(wait * (0.5 + this.#world.random()), () => this.#wanted > this.#known && this.#ask());
  }
}
