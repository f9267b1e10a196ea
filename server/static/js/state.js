// What the state of the battle means to one player: texts, icons, button, ranking. Pure.

import { UNKNOWN_BATTLE } from "./messages.js";

/** @typedef {import("./messages.js").Status} Status */

export const STOPPED = 0;
export const COUNTDOWN = 1;
export const PLAYING = 2;

const WARNING = 30; // s before the robot passes on to others

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
  const practising = status.practice && status.game === STOPPED && findUser(status, name) !== null;
  return practising || phaseOf(status, name) === "playing";
}

/**
 * The line beside "Game Status:" and the smaller one below it.
 * @param {string} refusal why this player's commands are refused now, for people
 */
export function gameText(status, name, refusal = "") {
  if (status.paused && findUser(status, name)) {
    return { text: "Paused by the operator", hint: "The clock stands and no robot moves. The game goes on soon." };
  }
  const seconds = Math.ceil(status.timeLeft);
  const seatLeft = Math.ceil(findUser(status, name)?.seat_left ?? 0);
  if (seatLeft > 0 && seatLeft <= WARNING) {
    return { text: "Press ready!", hint: `Others wait: in ${seatLeft} s your robot passes on.` };
  }
  switch (phaseOf(status, name)) {
    case "idle":
      if (status.practice) return { text: "Press ready to start!", hint: "Until the battle you can try out your robot." };
      return { text: "Press ready to start!", hint: status.notice || "The battle begins when two players are ready." };
    case "waiting":
      return { text: "Waiting for other players...", hint: status.notice || "One more ready player starts the countdown." };
    case "over":
      return { text: "Game over. Press ready to start again.", hint: status.notice };
    case "countdown":
      return { text: `${seconds} sec to start.`, hint: "Fingers on the controls." };
    case "joinable":
      return { text: `${seconds} sec to start.`, hint: "Press ready to join this battle." };
    case "playing":
      if (refusal) return { text: "Your robot does not obey", hint: refusal };
      return { text: "PLAY!", hint: "Hit the others, dodge their lasers." };
    case "out":
      return { text: "You are out: watch the others.", hint: "The ranking comes at the end of the battle." };
    case "watching":
      return { text: "The game has started without you.", hint: "You can join the next one." };
    default:
      return { text: "Looking for your robot...", hint: "" };
  }
}

/** Why rosbridge refuses the commands of a player in a battle, for people. `reason` is rosbridge's. */
export function refusalText(reason) {
  if (reason.includes("only signed-in players")) {
    return "This page is not signed in to it. The page tries again; if that does not help, reload it.";
  }
  if (reason.includes("referee")) return "The referee is silent, so all robots stand still. Wait a moment.";
  return `Its commands are refused: ${reason}.`;
}

/** Seconds as a clock, "4:05". */
export function clockText(seconds) {
  const whole = Math.max(0, Math.ceil(seconds));
  return `${Math.floor(whole / 60)}:${String(whole % 60).padStart(2, "0")}`;
}

/** The ready button. Whoever is ready in the countdown stays so; nobody changes it in a battle. */
export function readyButton(status, name) {
  const ready = findUser(status, name)?.ready ?? false;
  return {
    ready,
    text: ready ? "Ready!" : "Ready",
    disabled: status.game === PLAYING || (status.game === COUNTDOWN && ready),
  };
}

/** The icon of another player: its symbol, colour and meaning in words. */
export function userIcon(user, game) {
  if (!user.ready) return { symbol: "pause", color: "#f4bc42", meaning: "not ready" };
  if (user.life === 0 && game === PLAYING) return { symbol: "times", color: "#d33724", meaning: "out" };
  return { symbol: "play", color: "#00a65a", meaning: game === PLAYING ? "fighting" : "ready" };
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

/**
 * The ranking for people, by the server's result.
 * @param {import("./messages.js").Player[]} result
 * @returns {{title: string, text: string, won: boolean, rows: {place: number, name: string, note: string, avatar: number,
 *   isMe: boolean}[]}}
 */
export function ranking(result, name) {
  const mine = result.find((entry) => entry.name === name);
  const first = mine.place === 1;
  const tied = result.some((entry) => entry.name !== name && entry.place === mine.place);
  const title = first ? (tied ? "DRAW!" : "YOU WIN!") : "YOU LOST!";
  return {
    title,
    text: tied ? `You share place ${mine.place}.` : `Your place is ${mine.place}.`,
    won: first,
    rows: result.map((entry) => ({
      place: entry.place,
      name: entry.name,
      note: entry.left ? "left" : `${entry.life}%`,
      avatar: entry.avatar,
      isMe: entry.name === name,
    })),
  };
}

/** What a screen reader says when `current` follows `previous`; empty when nothing worth saying has changed. */
export function announcement(previous, current, name) {
  const phase = phaseOf(current, name);
  if (!phase) return "";
  if (!previous || phaseOf(previous, name) !== phase || previous.paused !== current.paused) {
    const { text, hint } = gameText(current, name);
    return `${text} ${hint}`.trim();
  }
  const lost = lifeLost(previous, current, name);
  return lost > 0 ? `Hit! Life ${findUser(current, name).life} percent.` : "";
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
  if (!web) {
    return {
      level: "bad",
      text: "Reconnecting...",
      banner: "The server does not answer. The page keeps trying; your robot stays yours for a while.",
    };
  }
  if (!bridge) {
    return {
      level: "warn",
      text: "Reconnecting...",
      banner: "The connection to your robot is down. The page keeps trying; until then you cannot drive.",
    };
  }
  return { level: "ok", text: "Online", banner: "" };
}
