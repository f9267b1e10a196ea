// The sound test on the desk: what a battle sounds like, on this device.

import { Speaker } from "../common/speaker.js";

const TUNE = ["last", "go", "shot", "hit", "win"];
const STEP = 700; // ms; also what the browser may take to open its audio
const LOUD = { sound: true, volume: 0.7 }; // whatever this browser's player has chosen

export class SoundCheck {
  #speaker = new Speaker({ get: (name) => LOUD[name], watch: () => {} });
  #timers = [];

  /** In answer to a press, without which browsers make no sound. */
  play() {
    this.#timers.forEach(clearTimeout);
    this.#speaker.wake();
    this.#timers = TUNE.map((name, index) => setTimeout(() => this.#speaker.play(name), (index + 1) * STEP));
  }
}
