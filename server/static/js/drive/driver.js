// From held keys to the stream of commands. The clock and the sending are injected.

import { NEUTRAL, commandOf, isNeutral, isSameCommand } from "./keys.js";

/** ms between two commands of a player while anything is held; the robot stops by itself after 300 ms of silence. */
export const STREAM_INTERVAL = 25;

/**
 * Sends each change at once and repeats a command that is not neutral. Whatever ends the driving (release, lost focus,
 * death, end of the battle) sends one neutral command, then silence.
 */
export class Driver {
  #send;
  #every;
  #interval;
  #held = new Map();
  #command = NEUTRAL;
  #driving = false;
  #cancelStream = null;
  #watchers = [];

  /**
   * @param {object} wiring
   * @param {(command: object) => void} wiring.send delivers a Robot_msg now or drops it
   * @param {(ms: number, act: () => void) => (() => void)} wiring.every repeats `act`; returns what ends it
   * @param {number} [wiring.interval] ms between two commands while anything is held
   */
  constructor({ send, every, interval = STREAM_INTERVAL }) {
    this.#send = send;
    this.#every = every;
    this.#interval = interval;
  }

  get driving() {
    return this.#driving;
  }

  /** `watcher` is called with true when the right to drive begins, with false when it ends. */
  watch(watcher) {
    this.#watchers.push(watcher);
  }

  /** The right to drive begins. Nothing is held yet: a key pressed before does not count. */
  start() {
    if (this.#driving) return;
    this.#driving = true;
    this.#send(NEUTRAL);
    this.#tell();
  }

  /** The right to drive ends. */
  stop() {
    if (!this.#driving) return;
    this.#driving = false;
    this.#held.clear();
    this.#endStream();
    this.#command = NEUTRAL;
    this.#send(NEUTRAL);
    this.#tell();
  }

  /**
   * `source` (a key, a finger) now holds exactly `actions`.
   * @param {string} source
   * @param {string[]} actions
   */
  hold(source, actions) {
    if (!this.#driving) return;
    this.#held.set(source, actions);
    this.#update();
  }

  release(source) {
    if (this.#held.delete(source)) this.#update();
  }

  /** Everything is let go: the page has lost the keyboard and will not hear of releases. */
  releaseAll() {
    this.#held.clear();
    this.#update();
  }

  /** The actions that are held now. */
  get actions() {
    return new Set([...this.#held.values()].flat());
  }

  #tell() {
    for (const watcher of this.#watchers) watcher(this.#driving);
  }

  #update() {
    const command = commandOf(this.actions);
    if (isSameCommand(command, this.#command)) return;
    this.#command = command;
    this.#endStream();
    this.#send(command);
    if (!isNeutral(command)) this.#cancelStream = this.#every(this.#interval, () => this.#send(this.#command));
  }

  #endStream() {
    this.#cancelStream?.();
    this.#cancelStream = null;
  }
}
