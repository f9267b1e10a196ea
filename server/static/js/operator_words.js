// The words and decisions of the operator's desk: what a state says, what may be pressed, what a form has changed. Pure.

import { clockText } from "./state.js";
import { waitText } from "./queue.js";

/** What may be added to the battle's time by one press, s. */
export const ADDED_TIME = 60;

/**
 * The battle in words.
 * @param {{state: string, paused: boolean, time_left: number, battle: number, notice: string}} game
 * @returns {{title: string, clock: string, hint: string}} an empty `clock`: none runs
 */
export function battleText({ state, paused, time_left, battle, notice }) {
  const clock = state === "stopped" ? "" : clockText(time_left);
  const hint = notice || `${battle} ${battle === 1 ? "battle has" : "battles have"} begun so far.`;
  if (paused) return { title: "Paused", clock, hint: "The clock stands, no robot moves and no hit counts." };
  switch (state) {
    case "stopped":
      return { title: "No battle", clock, hint };
    case "countdown":
      return { title: "Countdown", clock, hint: "Players may still get ready." };
    default:
      return { title: "Battle", clock, hint: `Battle number ${battle} is running.` };
  }
}

/**
 * The battle's buttons; the first of them changes between pause and resume.
 * @returns {Record<string, {action: string, text: string, enabled: boolean}>} by the button's id
 */
export function battleButtons({ state, paused }) {
  const runs = state !== "stopped";
  return {
    pause: { action: paused ? "resume" : "pause", text: paused ? "Resume" : "Pause", enabled: runs || paused },
    start: { action: "start", text: "Start now", enabled: state === "countdown" && !paused },
    "add-time": { action: "add_time", text: `+${ADDED_TIME} s`, enabled: runs },
    abort: { action: "abort", text: "Abort", enabled: runs },
  };
}

/** How long ago something was heard; null: never. */
export function ageText(seconds) {
  if (seconds === null) return "never";
  return seconds < 120 ? `${Math.round(seconds)} s ago` : `${Math.round(seconds / 60)} min ago`;
}

const SILENT = 2; // s; a robot pings every 0.4 s

/** Who has the robot, and what an operator should see at sight. `level` is "bad" for what needs a hand. */
export function robotText({ name, host, player, offered_to, in_service, ping_age, linked }) {
  const free = in_service ? "free" : "out of service";
  return {
    host: hostText(name, host),
    player: player ?? (offered_to === null ? free : `offered to ${offered_to}`),
    ping: { text: ageText(ping_age), level: ping_age === null || ping_age > SILENT ? "bad" : "" },
    link: { text: linked ? "linked" : "no link", level: linked ? "" : "bad" },
  };
}

/** Where a robot runs: "raspberrypi1.local", "virtual3 on 192.168.1.7". Either may be unknown (null). */
function hostText(name, host) {
  if (!name || !host || host.startsWith(name)) return host ?? name ?? "unknown";
  return `${name} on ${host}`;
}

/** What a player does now. */
export function playerText({ life, ready, seat_left, page_age }) {
  return {
    life: `${life} %`,
    ready: ready ? "ready" : "not ready",
    seat: seat_left > 0 ? `${Math.ceil(seat_left)} s` : "stays",
    page: { text: ageText(page_age), level: page_age > 5 ? "bad" : "" },
  };
}

/** What somebody who waits is told. */
export function waiterText({ offer, seconds }) {
  return offer === null ? `about ${waitText(seconds)}` : `robot ${offer} is offered for ${Math.ceil(seconds)} s more`;
}

/** A rule's name for people: "hit_damage" -> "Hit damage". */
export function ruleName(key) {
  const words = key.replaceAll("_", " ");
  return words.charAt(0).toUpperCase() + words.slice(1);
}

const valueText = (value) => (typeof value === "boolean" ? (value ? "on" : "off") : String(value));

/** What a rule means, which values it takes and which is its default. */
export function ruleText({ default: standard, min, max, text }) {
  const range = min === null ? "" : ` From ${min} to ${max}.`;
  const meaning = text.replace(/^1: /, ""); // an environment's flag is 0 or 1, the desk's a box
  return `${meaning.charAt(0).toUpperCase()}${meaning.slice(1)}.${range} Default: ${valueText(standard)}.`;
}

/**
 * The rules that a form wants otherwise than they are.
 * @param {Record<string, number|boolean>} wanted
 * @param {Record<string, {value: number|boolean}>} rules
 */
export function changedRules(wanted, rules) {
  return Object.fromEntries(Object.entries(wanted).filter(([name, value]) => rules[name].value !== value));
}

/** The words of a text with one on each line, each once. */
export function parseWords(text) {
  return [...new Set(text.split("\n").map((word) => word.trim()))].filter(Boolean);
}

/** A moment (unix s) as a clock on the operator's wall. */
export function timeText(at) {
  return new Date(at * 1000).toLocaleTimeString("en-GB");
}
