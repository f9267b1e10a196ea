// Which sounds, vibrations and jolts belong to what happens to a player. Pure but for what it is given to act with.

import { hitsOf, newHits } from "./hits.js";
import { COUNTDOWN, PLAYING, findUser, hasEnded, lifeLost, phaseOf } from "./state.js";

/** @typedef {import("./messages.js").Status} Status */

/** ms that a shot lasts; the robot ignores further ones meanwhile. */
export const SHOT = 500;

const LAST_SECONDS = 3; // of the countdown: they sound higher
const LOW = 20; // life from which the heart is heard
const HEARTBEAT = 1.1; // s

/** Moment -> what is felt; `vibrate` is ms on, off, on... */
const FEEDBACK = {
  tick: { sound: "tick" },
  last: { sound: "last" },
  go: { sound: "go" },
  given: { sound: "given", vibrate: [35] },
  kill: { sound: "kill", vibrate: [40, 50, 140] },
  hit: { sound: "hit", vibrate: [80], jolt: "hit" },
  out: { sound: "out", vibrate: [200, 80, 300], jolt: "out" },
  win: { sound: "win", vibrate: [60, 60, 60, 60, 240] },
  lose: { sound: "lose", vibrate: [300] },
};

/**
 * What has happened to a player between two states, in order; statuses in between may be missing.
 * @param {Status|null} previous null right after the page has been opened: then nothing is news
 * @param {Status} current
 * @param {string} name this player
 * @returns {("tick"|"last"|"go"|"given"|"kill"|"hit"|"out"|"win"|"lose")[]}
 */
export function moments(previous, current, name) {
  if (!previous) return [];
  const found = [];
  if (current.game === COUNTDOWN && secondsLeft(previous) !== secondsLeft(current) && secondsLeft(current) > 0) {
    found.push(secondsLeft(current) <= LAST_SECONDS ? "last" : "tick");
  }
  if (previous.game === COUNTDOWN && current.game === PLAYING) found.push("go");
  const { given } = hitsOf(newHits(previous, current), current, name);
  if (given.length > 0) found.push(given.some(({ life }) => life === 0) ? "kill" : "given");
  if (lifeLost(previous, current, name) > 0) found.push(findUser(current, name).life > 0 ? "hit" : "out");
  if (hasEnded(previous, current, name)) {
    found.push(current.result.find((entry) => entry.name === name).place === 1 ? "win" : "lose");
  }
  return found;
}

function secondsLeft(status) {
  return status.game === COUNTDOWN ? Math.ceil(status.timeLeft) : null;
}

/** Whether a player has so little life that the heart is heard. */
export function isLow(status, name) {
  return !status.paused && phaseOf(status, name) === "playing" && findUser(status, name).life <= LOW;
}

/** What one player of this page hears and feels. */
export class Feedback {
  #speaker;
  #vibrate;
  #jolt;
  #firedAt = -Infinity;

  /**
   * @param {object} wiring
   * @param {{play: (name: string) => void, repeat: (name: string, seconds: number) => void, quiet: () => void}} wiring.speaker
   * @param {(pattern: number[]) => void} wiring.vibrate
   * @param {(kind: "hit"|"out") => void} wiring.jolt shakes and flashes the stage
   */
  constructor({ speaker, vibrate, jolt }) {
    this.#speaker = speaker;
    this.#vibrate = vibrate;
    this.#jolt = jolt;
  }

  /** A new state of the battle has arrived. */
  take(previous, current, name) {
    this.#give(moments(previous, current, name));
    if (isLow(current, name)) this.#speaker.repeat("heartbeat", HEARTBEAT);
    else this.#speaker.quiet();
  }

  /**
   * A command with `shoot` has gone out at `now` (ms); they come 40 times a second while the button is held.
   * @returns {boolean} whether a shot begins with it
   */
  fire(now) {
    if (now - this.#firedAt < SHOT) return false;
    this.#firedAt = now;
    this.#speaker.play("shot");
    return true;
  }

  /** The page is left or knows nothing any more: the heart is not heard on. */
  stop() {
    this.#speaker.quiet();
  }

  #give(names) {
    const { sound, vibrate, jolt } = Object.assign({}, ...names.map((name) => FEEDBACK[name])); // the last is the most important
    if (sound) this.#speaker.play(sound);
    if (vibrate) this.#vibrate(vibrate);
    if (jolt) this.#jolt(jolt);
  }
}
