// The screen: all of it for the game, and awake while a robot is driven.

/**
 * A button that gives the page the whole screen and takes it back; hidden where the browser cannot, such as on an iPhone.
 * @param {HTMLElement} button
 * @param {Document} [page]
 */
export function connectFullscreen(button, page = document) {
  button.hidden = !page.fullscreenEnabled;
  if (button.hidden) return;
  const show = () => button.setAttribute("aria-pressed", String(page.fullscreenElement !== null));
  button.addEventListener("click", () => {
    const change = page.fullscreenElement ? page.exitFullscreen() : page.documentElement.requestFullscreen({ navigationUI: "hide" });
    change.catch(() => {}); // refused: the button keeps saying what is so
  });
  page.addEventListener("fullscreenchange", show);
  show();
}

/** Keeps the screen awake while that is wanted, also after the page was hidden, when browsers let it go. */
export class Awake {
  #api;
  #page;
  #wanted = false;
  #asking = false;
  #lock = null;

  /**
   * @param {{request: (type: "screen") => Promise<WakeLockSentinel>}|undefined} api navigator.wakeLock: only on pages by https or on this very computer
   * @param {Document} page
   */
  constructor(api, page) {
    this.#api = api;
    this.#page = page;
    page.addEventListener("visibilitychange", () => this.#update());
  }

  /** @param {boolean} wanted whether the screen is to stay awake */
  hold(wanted) {
    this.#wanted = wanted;
    this.#update();
  }

  async #update() {
    if (!this.#wanted) {
      this.#lock?.release();
      this.#lock = null;
      return;
    }
    const isHeld = this.#lock !== null && !this.#lock.released;
    if (!this.#api || this.#asking || isHeld || this.#page.visibilityState !== "visible") return;
    this.#asking = true;
    this.#lock = await this.#api.request("screen").catch(() => null); // refused, such as with a low battery
    this.#asking = false;
    if (!this.#wanted) this.#update(); // the wish has gone meanwhile
  }
}
