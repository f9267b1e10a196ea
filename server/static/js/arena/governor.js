// How many effects the picture has: as many as the machine draws in time. Pure.

/**
 * From all effects to the fewest. `glow` = layers of a beam, `smoke` = puffs over a robot that is out, `sparks` = of a
 * hit, `density` = the most canvas pixels for a CSS pixel, `pictures` = drawn a second at most.
 */
export const LEVELS = [
  { glow: 4, smoke: 8, sparks: 26, tracks: true, density: 2, pictures: 60 },
  { glow: 2, smoke: 5, sparks: 12, tracks: true, density: 1.5, pictures: 60 },
  { glow: 1, smoke: 3, sparks: 6, tracks: false, density: 1, pictures: 60 },
  { glow: 1, smoke: 0, sparks: 0, tracks: false, density: 1, pictures: 30 },
  { glow: 1, smoke: 0, sparks: 0, tracks: false, density: 1, pictures: 15 },
];

const SLOW = 20.5; // ms that pictures are waited for, on average; a screen of 50 Hz is not slow
const WINDOW = 1000; // ms that are judged together
const PAUSE = 500; // ms that a picture is waited for: a hidden tab, not a slow one
const PATIENCE = 10_000; // ms in time before one level up is tried
const MOST_PATIENCE = 320_000; // it doubles with each try that was too much

export class Governor {
  #level = 0;
  #start = null; // of the window
  #waited = 0; // ms, for the pictures of the window
  #pictures = 0;
  #inTimeSince = null;
  #patience = PATIENCE;
  #tried = false; // the present level is a try

  /** The number of the level, 0 = all effects. */
  get level() {
    return this.#level;
  }

  get effects() {
    return LEVELS[this.level];
  }

  /** The screen is asked for nothing for a while: that it shows nothing is not slow. */
  rest() {
    this.#start = null;
  }

  /** The screen is ready at `now` (ms) for a picture, `waited` ms after it was asked for it. */
  picture(now, waited) {
    if (this.#start === null || waited > PAUSE) {
      this.#begin(now);
      this.#inTimeSince = now;
      return;
    }
    this.#waited += waited;
    this.#pictures += 1;
    if (now - this.#start < WINDOW) return;
    const mean = this.#waited / this.#pictures;
    this.#begin(now);
    if (mean > SLOW) this.#lower(now);
    else if (this.#level > 0 && now - this.#inTimeSince >= this.#patience) this.#raise(now);
  }

  #begin(now) {
    this.#start = now;
    this.#waited = this.#pictures = 0;
  }

  #lower(now) {
    if (this.#tried) this.#patience = Math.min(MOST_PATIENCE, 2 * this.#patience);
    this.#tried = false;
    this.#level = Math.min(LEVELS.length - 1, this.#level + 1);
    this.#inTimeSince = now;
  }

  #raise(now) {
    this.#level -= 1;
    this.#tried = true;
    this.#inTimeSince = now;
  }
}
