// What the state of the battle means to one player: texts, icons, button. Pure.

import { DOUBLE_DAMAGE, SHIELD } from "./effects.js";
import { hitsOf, newHits } from "./hits.js";
import { UNKNOWN_BATTLE } from "./messages.js";
import { noticeText, saysBattleOver } from "../common/notice.js";
import { teamName } from "./teams.js";
import { t } from "../common/words.js";

/** @typedef {import("./messages.js").Status} Status */

export const STOPPED = 0;
export const COUNTDOWN = 1;
export const PLAYING = 2;

const WARNING = 30; // s before the robot goes to others

/**
 * Where this player stands; also the name of the stage's look.
 * @param {Status} status
 * @param {string} name this player
 * @returns {"idle"|"waiting"|"over"|"countdown"|"joinable"|"playing"|"out"|"watching"|null} null: not in the status
 */
export function phaseOf(status, name) {
  const me = findUser(status, name);
  if (!me) return null;
  if (status.game === COUNTDOWN) return me.ready ? "countdown" : "joinable";
  if (status.game === PLAYING) {
    if (!me.ready) return "watching";
    return me.life > 0 ? "playing" : "out";
  }
  if (me.ready) return "waiting";
  return status.result.some((entry) => entry.name === name) ? "over" : "idle";
}

export function findUser(status, name) {
  return status.users.find((user) => user.name === name) ?? null;
}

/** Whether this player's commands count now. */
export function mayDrive(status, name) {
  if (status.paused) return false;
  const phase = phaseOf(status, name);
  if (phase === null) return false;
  return phase === "playing" || (status.practice && status.game === STOPPED) || (status.practiceBeside && phase === "watching");
}

/** Whether light goes out when this player shoots: beside a battle of others, none does. */
export const mayShoot = (status, name) => mayDrive(status, name) && phaseOf(status, name) !== "watching";

/**
 * The line that says how the game stands for this player, and a smaller one below it.
 * @param {string} refusal why this player's commands are refused now, for people
 */
export function gameText(status, name, refusal = "") {
  const phase = phaseOf(status, name);
  if (status.paused && phase) return { text: t("game.paused"), hint: t("game.paused_hint") };
  const n = Math.ceil(status.timeLeft);
  const seatLeft = Math.ceil(findUser(status, name)?.seat_left ?? 0);
  if (seatLeft > 0 && seatLeft <= WARNING) return { text: t("game.seat"), hint: t("game.seat_hint", { n: seatLeft }) };
  const notice = noticeText(status.notice);
  if (mayDrive(status, name) && findUser(status, name).fence) return { text: t("game.edge"), hint: t("game.edge_hint") };
  switch (phase) {
    case "idle": {
      const news = saysBattleOver(status.notice) ? "" : notice; // the end of a battle of others is none
      return { text: t("game.idle"), hint: status.practice ? t("game.practice") : news || t("game.idle_hint") };
    }
    case "waiting":
      return { text: t("game.waiting"), hint: (!saysBattleOver(status.notice) && notice) || t("game.waiting_hint") };
    case "over":
      return { text: t("game.over"), hint: notice };
    case "countdown":
      return { text: t("game.countdown", { n }), hint: handicapHint(findUser(status, name)) || t("game.countdown_hint") };
    case "joinable":
      return { text: t("game.countdown", { n }), hint: t("game.joinable_hint") };
    case "playing":
      if (refusal) return { text: t("game.refused"), hint: refusal };
      return { text: t("game.playing"), hint: playingHint(findUser(status, name)) };
    case "out":
      return { text: t("game.out"), hint: t("game.out_hint") };
    case "watching":
      return { text: t("game.watching"), hint: t(watchingHint(status, findUser(status, name))) };
    default:
      return { text: t("game.looking"), hint: "" };
  }
}

function watchingHint({ practiceBeside }, { may_join }) {
  if (may_join) return "game.late_join_hint";
  return practiceBeside ? "game.practice_beside" : "game.watching_hint";
}

/** What works for a player now, and what is gained so far; else what is to be done. */
function playingHint(me) {
  const told = [me.effects & SHIELD && t("game.shield"), me.effects & DOUBLE_DAMAGE && t("game.double_damage"), hillText(me)].filter(Boolean);
  if (told.length > 0) return told.join(" ");
  return me.team > 0 ? t("game.playing_team", { team: teamName(me.team) }) : t("game.playing_hint");
}

/** For how long a player has held hills, in words; empty if never. */
export const hillText = ({ points }) => (points > 0 ? t("game.hill", { n: points }) : "");

const handicapHint = ({ handicap }) => (handicap > 0 ? t("game.handicap_own", { n: handicap }) : "");

/** How much less damage a player takes than others, in words; empty if it is as much. */
export const handicapText = ({ handicap }) => (handicap > 0 ? t("game.handicap", { n: handicap }) : "");

/** For how many seconds nobody can be hit, in words; empty for 0. */
export const protectionText = (seconds) => (seconds > 0 ? t("game.protected", { n: Math.ceil(seconds) }) : "");

/** Why rosbridge refuses the commands of a player in a battle, for people. `reason` is rosbridge's. */
export function refusalText(reason) {
  if (reason.includes("only signed-in players")) return t("game.not_signed_in");
  if (reason.includes("referee")) return t("game.no_referee");
  return t("game.refused_because", { reason });
}

/** Seconds as a clock, "4:05". */
export function clockText(seconds) {
  const whole = Math.max(0, Math.ceil(seconds));
  return `${Math.floor(whole / 60)}:${String(whole % 60).padStart(2, "0")}`;
}

/**
 * The ready button: there is none for whom it would change nothing. Whoever is ready in the countdown stays so; in a
 * battle, it is for those who may still join.
 */
export function readyButton(status, name) {
  const me = findUser(status, name);
  const ready = me?.ready ?? false;
  const joins = status.game === PLAYING && (me?.may_join ?? false);
  const useless = (status.game === PLAYING && !joins) || (status.game === COUNTDOWN && ready);
  const key = joins ? "game.join" : ready ? "game.is_ready" : "game.ready";
  return { ready, text: t(key), hidden: useless };
}

/** What a player may choose of the teams: null if there are none, or not now. */
export function teamChoice(status, name) {
  const me = findUser(status, name);
  const mayChoose = status.teams > 0 && status.game !== PLAYING && !readyButton(status, name).hidden;
  return me && mayChoose ? { teams: status.teams, own: me.team, users: status.users } : null;
}

/** How a player stands: the symbol and its meaning in words. */
export function userSign(user, game) {
  if (!user.ready) return { symbol: "pause", meaning: t("game.sign_not_ready") };
  if (user.life === 0 && game === PLAYING) return { symbol: "times", meaning: t("game.sign_out") };
  return { symbol: "play", meaning: t(game === PLAYING ? "game.sign_fighting" : "game.sign_ready") };
}

/** Everybody but this player, best first. */
export function others(status, name) {
  return status.users.filter((user) => user.name !== name);
}

/**
 * Whether the last battle of this player has ended between two states; some in between may be missing.
 * @param {Status|null} previous null right after the page has been opened: what is over then is no news
 * @param {Status} current
 */
export function hasEnded(previous, current, name) {
  if (!previous || current.game !== STOPPED) return false;
  const wasKnown = previous.battle !== UNKNOWN_BATTLE;
  const isOther = previous.battle !== current.battle || previous.result.length === 0;
  const isNews = previous.game === PLAYING || (wasKnown && isOther);
  return isNews && current.result.some((entry) => entry.name === name && !entry.left);
}

/** What a screen reader says when `current` follows `previous`; empty when nothing worth saying has changed. */
export function announcement(previous, current, name) {
  const phase = phaseOf(current, name);
  if (!phase) return "";
  const hits = hitsOf(newHits(previous, current), current, name);
  const given = hits.given.map((hit) => (hit.life > 0 ? t("game.given", hit) : t("game.kill", hit)));
  if (!previous || phaseOf(previous, name) !== phase || previous.paused !== current.paused) {
    const { text, hint } = gameText(current, name);
    const last = hits.taken.at(-1);
    const end = last?.by && last.life === 0 ? t("game.out_by", { name: last.by }) : "";
    const safe = phase === "playing" ? protectionText(current.protection) : "";
    return [...given, end, text, hint, safe].filter(Boolean).join(" ");
  }
  if (lifeLost(previous, current, name) > 0) given.push(hurtText(findUser(current, name).life, hits.taken.at(-1)?.by));
  return given.join(" ");
}

function hurtText(life, by) {
  return by ? `${t("game.hit_by", { name: by })} ${t("game.life", { life })}` : t("game.hit", { life });
}

/** Life that this player has lost between two states of one battle. */
export function lifeLost(previous, current, name) {
  if (previous?.game !== PLAYING) return 0;
  const before = findUser(previous, name);
  const after = findUser(current, name);
  return before && after ? Math.max(0, before.life - after.life) : 0;
}

/**
 * The connection in words.
 * @param {boolean} bridge whether the WebSocket to rosbridge is up
 * @param {boolean} web whether the web server answers
 * @returns {{level: "ok"|"warn"|"bad", text: string, banner: string}}
 */
export function connectionState(bridge, web) {
  const text = t("game.reconnecting");
  if (!web) return { level: "bad", text, banner: t("game.no_server") };
  if (!bridge) return { level: "warn", text, banner: t("game.no_bridge") };
  return { level: "ok", text: t("game.online"), banner: "" };
}
