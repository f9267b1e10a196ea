// The page's sign of life, which is also the state of the battle when the WebSocket is down.

/** ms between two beats; the server forgets a player after 15 s of silence. */
export const BEAT_INTERVAL = 2000;
/** ms between two beats while they are the only source of the state, or while the server does not answer. */
export const FAST_INTERVAL = 500;
/** Failures in a row after which the server counts as lost. */
export const LOST_AFTER = 2;

/**
 * Beats when it is due and nothing is under way. `tick` comes from a timer and from each arriving status message, because
 * browsers slow the timers of hidden tabs down, but not messages.
 */
export class Heartbeat {
  #post;
  #now;
  #onReply;
  #onLost;
  #onBack;
  #last = -Infinity;
  #failures = 0;
  #busy = false;

  /**
   * @param {object} wiring
   * @param {() => Promise<object>} wiring.post asks the server; rejects when it does not answer
   * @param {() => number} wiring.now ms
   * @param {(reply: object) => void} wiring.onReply
   * @param {() => void} wiring.onLost the server has stopped answering
   * @param {() => void} wiring.onBack it answers again
   */
  constructor({ post, now, onReply, onLost, onBack }) {
    this.#post = post;
    this.#now = now;
    this.#onReply = onReply;
    this.#onLost = onLost;
    this.#onBack = onBack;
  }

  get lost() {
    return this.#failures >= LOST_AFTER;
  }

  /** @param {boolean} isOnlySource whether the state comes by the beats alone now */
  async tick(isOnlySource) {
    const interval = isOnlySource || this.#failures > 0 ? FAST_INTERVAL : BEAT_INTERVAL;
    if (this.#busy || this.#now() - this.#last < interval) return;
    this.#busy = true;
    this.#last = this.#now();
    const reply = await this.#post().catch(() => null);
    this.#busy = false;
    if (reply === null) {
      this.#failures += 1;
      if (this.#failures === LOST_AFTER) this.#onLost();
      return;
    }
    const wasLost = this.lost;
    this.#failures = 0;
    if (wasLost) this.#onBack();
    this.#onReply(reply);
  }
}
