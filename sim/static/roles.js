// Who plays which robot, as far as it is known, and when the battle has begun. Pure.

const BEGINS = ["countdown", "playing"]; // phases at which a player looks for the own robot

/** @typedef {{player: import("./players.js").Player, isMe: boolean, out: boolean}} Role */

export class Roles {
  #roles = new Map(); // robot's ID -> Role
  #phase = "";
  #startedAt = -Infinity;
  #ownWords;

  /** @param {{you: string, hit: string, empty: string}} words unless the page around the arena has others */
  constructor(words) {
    this.words = this.#ownWords = words;
    /** Whether anything is known of who plays. */
    this.known = false;
  }

  /**
   * Take the newest news.
   * @param {import("./players.js").Players|null} players null: nobody tells any more
   * @param {number} now s
   */
  take(players, now) {
    this.known = players !== null;
    this.words = { ...this.#ownWords, ...players?.labels };
    const phase = players?.phase ?? "";
    if (phase !== this.#phase && BEGINS.includes(phase)) this.#startedAt = now;
    this.#phase = phase;
    const roleOf = (player) => ({ player, isMe: player.name === players.me, out: player.out });
    this.#roles = new Map((players?.players ?? []).map((player) => [player.robot, roleOf(player)]));
  }

  /** Who plays a robot of the view. @returns {Role|undefined} */
  of(robot) {
    return this.#roles.get(robot.id);
  }

  /** s since a countdown or a battle has begun. */
  sinceStart(now) {
    return now - this.#startedAt;
  }

  /** Whether a robot of the picture smokes. */
  get smokes() {
    return [...this.#roles.values()].some(({ out }) => out);
  }

  /** Whether somebody at this picture drives a robot. */
  get drives() {
    return [...this.#roles.values()].some(({ isMe }) => isMe);
  }
}
