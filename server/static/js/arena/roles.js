// Who plays which robot, as far as it is known, and when the battle has begun. Pure.

const BEGINS = ["countdown", "playing"]; // phases at which a player looks for the own robot

/** @typedef {{name: string, robot: number, avatar: string|null, life: number, out: boolean, ready: boolean,
 *   colour: string|null, shield: boolean, doubleDamage: boolean}} Player */
/** @typedef {{me: string|null, phase: string, players: Player[]}} Players `me`: this page's own; null for a spectator */
/** @typedef {{player: Player, isMe: boolean, out: boolean}} Role */

export class Roles {
  #roles = new Map(); // robot's ID -> Role
  #phase = "";
  #startedAt = -Infinity;

  /** @param {{you: string, hit: string}} words in the picture */
  constructor(words) {
    this.words = words;
    /** Whether anything is known of who plays. */
    this.known = false;
  }

  /**
   * Take the newest news.
   * @param {Players} players
   * @param {number} now s
   */
  take(players, now) {
    this.known = true;
    const { me, phase } = players;
    if (phase !== this.#phase && BEGINS.includes(phase)) this.#startedAt = now;
    this.#phase = phase;
    const roleOf = (player) => ({ player, isMe: player.name === me, out: player.out });
    this.#roles = new Map(players.players.map((player) => [player.robot, roleOf(player)]));
  }

  /** Who plays a robot. @returns {Role|undefined} */
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
