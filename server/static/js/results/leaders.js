// The leaderboard of the day: /results/leaderboard.json, see docs/results.md.

import { element } from "../common/dom.js";
import { number, t } from "../common/words.js";

const POLL = 30_000; // ms between two questions
const WRITTEN = 3_000; // ms after which a battle that has ended is in the database
const SPREAD = 8_000; // ms over which many pages spread their question after a battle
const SHOWN = 8; // players
const TIMEOUT = 4000; // ms

/** @typedef {{place: number, name: string, wins: number, battles: number}} Leader */

/**
 * The day by the server's clock, whose days the leaderboard has.
 * @param {number} now Unix time in ms
 * @param {number} offset of the server's time zone from UTC, in minutes
 */
export const serverDay = (now, offset) => new Date(now + offset * 60_000).toISOString().slice(0, 10);

/** Asks the server; the answer's players. It is nobody's sign of life: no cookie goes along. */
export async function askLeaders(day) {
  const address = `/results/leaderboard.json?day=${day}`;
  const response = await fetch(address, { cache: "no-store", credentials: "omit", signal: AbortSignal.timeout(TIMEOUT) });
  if (!response.ok) throw new Error(`${address}: ${response.status}`);
  return (await response.json()).players;
}

/** Keeps the first players of the day, asked for now and then between battles: during one nothing changes. */
export class Leaders {
  #ask;
  #clock;
  #next = -Infinity;
  #busy = false;

  /**
   * @param {() => Promise<Leader[]>} ask
   * @param {{now: () => number, random: () => number}} clock now() in ms; random() from 0 to 1
   */
  constructor(ask, clock = { now: () => performance.now(), random: Math.random }) {
    this.#ask = ask;
    this.#clock = clock;
  }

  /** @type {Leader[]} best first */
  players = [];

  /** Ask if it is time. @param {boolean} isBetween whether no battle runs now */
  async tick(isBetween) {
    const now = this.#clock.now();
    if (!isBetween) this.#next = now + WRITTEN + SPREAD * this.#clock.random();
    if (this.#busy || now < this.#next) return;
    this.#busy = true;
    this.#next = now + POLL;
    const players = await this.#ask().catch(() => null); // what is known stays
    this.#busy = false;
    if (players) this.players = players.slice(0, SHOWN);
  }
}

/** The leaderboard as a table. @param {Leader[]} players */
export function leadersView(players) {
  const columns = ["place", "name", "wins", "battles"];
  const head = columns.map((column) => element("th", { scope: "col", className: `is-${column}` }, t(`leaders.${column}`)));
  const rows = players.map((player) =>
    element(
      "tr",
      {},
      element("td", { className: "is-place" }, number(player.place)),
      element("td", { className: "is-name" }, player.name),
      element("td", { className: "is-wins" }, number(player.wins)),
      element("td", { className: "is-battles" }, number(player.battles)),
    ),
  );
  return element("table", { className: "leaders" }, element("thead", {}, element("tr", {}, ...head)), element("tbody", {}, ...rows));
}
