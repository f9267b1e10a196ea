// The arena's picture inside a page of the game: an iframe of another port that is told who plays and tells whether it
// lives. docs/protocol-browser.md, "The arena's view".

const TICK = 1000; // ms between two looks
const LATE = 3000; // ms between two looks after which this page itself was too busy, or hidden, to hear anything
const SILENCE = 6000; // ms; the arena speaks at least every 2 s
const RELOAD = 5000; // ms between two attempts to load the arena

/** @typedef {"connecting"|"live"|"lost"|"unreachable"} ArenaState */

/**
 * Shows the arena in `frame`, which stays hidden until the arena itself speaks: a browser's own error page is never seen.
 */
export class ArenaView {
  #frame;
  #url;
  #origin;
  #onState;
  #clock;
  #stop;
  #players = null;
  #scale = 1;
  #state = "connecting";
  #heard = false; // since the frame has last been loaded
  #heardAt;
  #loadedAt;
  #lookedAt;

  /**
   * @param {{frame: HTMLIFrameElement, url: string, onState: (state: ArenaState) => void, clock?: object}} options
   *   `url` of the arena's page; `clock` = {now(), every(ms, act), listen(act), isHidden()}, in tests
   */
  constructor({ frame, url, onState, clock = browserClock }) {
    this.#frame = frame;
    this.#url = new URL("?embedded", url).href;
    this.#origin = new URL(url).origin;
    this.#onState = onState;
    this.#clock = clock;
    this.#lookedAt = clock.now();
    const stops = [clock.listen((event) => this.#hear(event)), clock.every(TICK, () => this.#look())];
    this.#stop = () => stops.forEach((stop) => stop());
    this.#load();
  }

  /** The arena's last report, {state, fps, effects}, null before the first. */
  report = null;

  /** What it last was. @returns {ArenaState} */
  get state() {
    return this.#state;
  }

  /**
   * Tell the arena who plays, now and whenever it begins anew.
   * @param {{me: string|null, players: object[], phase: string, labels?: object, effects?: "full"|"reduced"|"auto"}} players
   */
  show(players) {
    const isNews = JSON.stringify(players) !== JSON.stringify(this.#players);
    this.#players = players;
    if (isNews) this.#post();
  }

  /** At how much of its size the page shows the frame, by a transform: motion is slower in a small picture, which is drawn less often. @param {number} scale */
  set scale(scale) {
    if (scale === this.#scale) return;
    this.#scale = scale;
    this.#post();
  }

  /** No more of it. */
  close() {
    this.#stop();
  }

  #load() {
    this.#heard = false;
    this.#heardAt = this.#loadedAt = this.#clock.now();
    this.#frame.hidden = true;
    this.#frame.src = this.#url;
  }

  #hear({ source, origin, data }) {
    if (source !== this.#frame.contentWindow || origin !== this.#origin || data?.type !== "laserbot-arena") return;
    if (!["connecting", "live", "lost"].includes(data.state)) return;
    this.#heardAt = this.#clock.now();
    this.report = data;
    const isNew = !this.#heard || data.state !== this.#state;
    this.#heard = true;
    this.#frame.hidden = false;
    this.#become(data.state);
    if (isNew) this.#post();
  }

  #look() {
    const now = this.#clock.now();
    const wasAway = now - this.#lookedAt > LATE || this.#clock.isHidden();
    this.#lookedAt = now;
    if (wasAway) this.#heardAt = now; // what the arena has said meanwhile is still to be read
    if (now - this.#heardAt < SILENCE) return;
    const isDue = this.#state !== "unreachable" || now - this.#loadedAt >= RELOAD;
    this.#become("unreachable");
    if (!isDue) return;
    const heardAt = this.#heardAt;
    this.#load();
    this.#heardAt = heardAt; // it stays silent until it speaks
  }

  #become(state) {
    if (state === this.#state) return;
    this.#state = state;
    this.#onState(state);
  }

  #post() {
    if (!this.#heard || !this.#players) return;
    this.#frame.contentWindow.postMessage({ type: "laserbot-players", scale: this.#scale, ...this.#players }, this.#origin);
  }
}

const browserClock = {
  now: () => performance.now(),
  every(ms, act) {
    const timer = setInterval(act, ms);
    return () => clearInterval(timer);
  },
  listen(act) {
    window.addEventListener("message", act);
    return () => window.removeEventListener("message", act);
  },
  isHidden: () => document.hidden,
};
