// The words and decisions of the operator's desk: what a state says, what may be pressed, what a form has changed. Pure.

import { ABOVE } from "../camera/picture.js";
import { noticeText } from "../common/notice.js";
import { clock as clockText } from "../results/replay.js";
import { dateTime, number, percent, t } from "../common/words.js";

/** What may be added to the battle's time by one press, s. */
export const ADDED_TIME = 60;

/**
 * The battle in words.
 * @param {{state: string, paused: boolean, time_left: number, battle: number, notice: string}} game
 * @returns {{title: string, clock: string, hint: string}} an empty `clock`: none runs
 */
export function battleText({ state, paused, time_left, battle, notice }) {
  const clock = state === "stopped" ? "" : clockText(Math.ceil(time_left));
  const hint = noticeText(notice) || t("desk.begun", { n: battle });
  if (paused) return { title: t("desk.paused"), clock, hint: t("desk.paused_hint") };
  switch (state) {
    case "stopped":
      return { title: t("desk.no_battle"), clock, hint };
    case "countdown":
      return { title: t("desk.countdown"), clock, hint: t("desk.countdown_hint") };
    default:
      return { title: t("desk.battle"), clock, hint: t("desk.battle_hint", { number: String(battle) }) };
  }
}

/**
 * The battle's buttons; the first of them changes between pause and resume.
 * @param {{state: string, paused: boolean, why_no_start: ""|"runs"|"too_few"|"match"}} game
 * @returns {Record<string, {action: string, text: string, why: string}>} by the button's id; `why` it cannot be pressed
 *   now, empty if it can
 */
export function battleButtons({ state, paused, why_no_start }) {
  const nothing = state === "stopped" ? t("desk.why_nothing_runs") : "";
  return {
    pause: { action: paused ? "resume" : "pause", text: t(paused ? "desk.resume" : "desk.pause"), why: nothing },
    start: { action: "start", text: t("desk.start"), why: why_no_start && t(WHY_NO_START[why_no_start]) },
    "add-time": { action: "add_time", text: t("desk.add_time", { n: ADDED_TIME }), why: nothing },
    abort: { action: "abort", text: t("desk.abort"), why: nothing },
  };
}

const WHY_NO_START = { runs: "desk.why_runs", too_few: "desk.why_too_few", match: "desk.why_match" };

/** How long ago something was heard; null: never. */
export function ageText(seconds) {
  if (seconds === null) return t("desk.never");
  return seconds < 120 ? t("desk.seconds_ago", { n: Math.round(seconds) }) : t("desk.minutes_ago", { n: Math.round(seconds / 60) });
}

const SILENT = 2; // s; a robot pings every 0.4 s

/** Who has the robot, and what an operator should see at sight. `level` is "bad" for what needs a hand. */
export function robotText({ name, host, player, offered_to, in_service, ping_age, linked }) {
  const free = t(in_service ? "desk.free" : "desk.out_of_service");
  return {
    host: hostText(name, host),
    player: player ?? (offered_to === null ? free : t("desk.offered_to", { name: offered_to })),
    ping: { text: ageText(ping_age), level: ping_age === null || ping_age > SILENT ? "bad" : "" },
    link: { text: t(linked ? "desk.linked" : "desk.no_link"), level: linked ? "" : "bad" },
  };
}

/** Where a robot runs: "raspberrypi1.local", "virtual3 on 192.168.1.7". Either may be unknown (null). */
function hostText(name, host) {
  if (!name || !host || host.startsWith(name)) return host ?? name ?? t("desk.unknown");
  return t("desk.host_on", { name, host });
}

const WARNINGS = {
  silent: "desk.health_silent",
  low_supply: "desk.health_low_supply",
  under_voltage: "desk.health_under_voltage",
  deaf: "desk.health_deaf",
  wrong_light: "desk.health_wrong_light",
};

/** How a robot is, in a few words; null: it has said nothing. */
export function healthText(health) {
  if (health === null) return t("desk.health_unknown");
  const { board, temperature, wifi, warnings } = health;
  const battery = board?.battery;
  const signs = warnings.map((warning) => t(WARNINGS[warning]));
  const facts = [
    board?.supply > 0 && voltText(board.supply),
    battery > 0 && t("desk.health_battery", { volt: voltText(battery) }),
    temperature !== 0 && t("desk.health_temperature", { n: number(Math.round(temperature)) }),
    wifi !== 0 && t("desk.health_wifi", { n: number(wifi) }),
  ];
  const text = [...signs, ...facts.filter(Boolean)].join(", ");
  return { text: text || t("desk.health_fine"), level: warnings.length > 0 ? "bad" : "" };
}

const voltText = (millivolts) => `${number(Math.round(millivolts / 10) / 100)} V`;

const RESETS = ["power on", "reset pin", "supply too low", "watchdog"]; // by bit, as in BoardHealth.msg

/** All that a robot says about itself, for a closer look; in English, like the log. */
export function healthDetails(health) {
  if (health === null) return "";
  const { board, age, cpu } = health;
  const pi = [`heard ${Math.round(age)} s ago`, `CPU ${Math.round(cpu * 100)} %`];
  if (board === null) return [...pi, "no report of the Arduino"].join(", ");
  const resets = RESETS.filter((_, bit) => board.reset_cause & (1 << bit)).join(" and ") || "unknown";
  return [
    ...pi,
    `firmware ${board.major}.${board.minor} (${board.hash.toString(16).padStart(4, "0")})`,
    `up ${clockText(board.uptime)}, last reset: ${resets}`,
    `longest turn ${board.loop_max} us, serial round trip ${board.round_trip} us`,
    `serial errors ${board.serial_errors}, resyncs ${board.resyncs}, overruns ${board.overruns}`,
    `light packets ${board.packets}, broken ones ${board.bad_packets}, shots ${board.shots}`,
  ].join("\n");
}

/** What a player does now. */
export function playerText({ life, ready, seat_left, page_age }) {
  return {
    life: percent(life),
    ready: t(ready ? "desk.is_ready" : "desk.not_ready"),
    seat: seat_left > 0 ? t("desk.seconds", { n: Math.ceil(seat_left) }) : t("desk.stays"),
    page: { text: ageText(page_age), level: page_age > 5 ? "bad" : "" },
  };
}

/** What somebody who waits is told. */
export function waiterText({ offer, seconds }) {
  if (offer === null) return t("desk.wait", { n: Math.max(1, Math.round(seconds / 60)) });
  return t("desk.offered", { id: offer, n: Math.ceil(seconds) });
}

/** The words of a text with one on each line, each once. */
export function parseWords(text) {
  return [...new Set(text.split("\n").map((word) => word.trim()))].filter(Boolean);
}

/** A moment (unix s) as a clock on the operator's wall, which has 24 hours. */
export function timeText(at) {
  return dateTime(new Date(at * 1000), { timeStyle: "medium", hourCycle: "h23" });
}

const LATE = 1; // s; the picture is grey then

/**
 * A camera that somebody looks through, as the relay's figures tell of it.
 * @param {{robot: number, viewers: number, rate: number, age: number|null, kilobytes: number|null, state: string}} camera
 */
export function cameraRow({ robot, viewers, rate, age, kilobytes, state }) {
  return {
    id: robot === ABOVE ? t("desk.camera_above") : t("desk.robot_id", { id: robot }),
    state: { text: t(`desk.camera_${state}`), level: state === "waiting" ? "bad" : "" },
    viewers: number(viewers),
    rate: t("desk.per_second", { n: number(rate) }),
    age: age === null ? "-" : { text: t("desk.camera_seconds", { n: number(age, { maximumFractionDigits: 2 }) }), level: age > LATE ? "bad" : "" },
    size: kilobytes === null ? "-" : t("desk.kilobytes", { n: number(kilobytes) }),
  };
}
