// The game page's elements, set from the state. It keeps nothing but what is needed to change as little as possible.

import { avatarUrl } from "../common/assets.js";
import { element, icon, lifeBar, setLife, setPicture, setText } from "../common/dom.js";
import { wearColour } from "../common/robot_colours.js";
import * as state from "../battle/state.js";
import { makeMark, showMark } from "../battle/team_view.js";
import { byTeam } from "../battle/teams.js";
import { number, percent, t } from "../common/words.js";

const byId = (id) => document.getElementById(id);

/** Name, robot, picture and date of the player, wherever the page shows them. */
export function showPlayer({ name, robot, avatar, date }) {
  const set = (selector, text) => document.querySelectorAll(selector).forEach((node) => setText(node, text));
  set(".username", name);
  document.querySelector(".own-name").title = name; // it may be cut
  set(".robotN", t("home.robot", { id: String(robot) }));
  set(".date", t("home.logged_in", { date }));
  for (const picture of document.querySelectorAll(".userImage")) showPicture(picture, avatar, robot);
}

/** A player's picture, in the colour of the robot. */
function showPicture(picture, avatar, robot) {
  setPicture(picture, avatarUrl(avatar));
  wearColour(picture, robot);
}

/** Everything that depends on the state of the battle; `refusal` is why commands are refused now, for people. */
export function showStatus(status, name, refusal) {
  const phase = state.phaseOf(status, name) ?? "idle";
  const { text, hint } = state.gameText(status, name, refusal);
  document.body.dataset.phase = phase;
  document.body.dataset.paused = status.paused;
  document.body.dataset.refused = Boolean(refusal);
  const message = byId("message");
  message.hidden = status.message === "";
  setText(message, status.message);
  setText(byId("game-status"), text);
  setText(byId("game-hint"), hint);
  showClock(status);
  showReadyButton(state.readyButton(status, name));
  const me = state.findUser(status, name);
  if (me) showOwn(me);
  showProtection(phase === "playing" ? status.protection : 0);
  const others = state.others(status, name);
  byId("nobody").hidden = others.length > 0;
  const waiting = byId("waiting");
  waiting.hidden = status.queue === 0;
  if (status.queue > 0) setText(waiting, t("home.queue", { n: status.queue }));
  showRows(byId("userList"), others, makeRival, (row, user) => fillRival(row, user, status.game));
  markGroups(byId("userList"), status);
  showRows(byId("seats"), byTeam(status.users), makeSeat, (seat, user) => fillSeat(seat, user, status.game, name));
}

function showClock(status) {
  const clock = byId("clock");
  clock.hidden = status.game !== state.PLAYING;
  if (clock.hidden) return;
  setText(clock.lastElementChild, state.clockText(status.timeLeft));
  clock.dataset.last = status.timeLeft <= 30;
}

/** The seconds to the start, over the whole picture. @returns {boolean} whether a new one has begun */
export function showCountdown(status) {
  const shown = byId("countdown");
  shown.hidden = status.game !== state.COUNTDOWN;
  const seconds = shown.hidden ? "" : number(Math.ceil(status.timeLeft));
  if (shown.textContent === seconds) return false;
  shown.textContent = seconds;
  return !shown.hidden;
}

function showReadyButton({ ready, text, hidden }) {
  const button = byId("ready-btn");
  setText(button.querySelector("span"), text);
  button.dataset.ready = ready;
  button.setAttribute("aria-pressed", ready);
  if (hidden && document.activeElement === button) button.blur(); // a hidden button would keep the keys to itself
  button.hidden = hidden;
}

function showOwn(me) {
  const { life, team, weak } = me;
  const box = byId("userLife");
  showMark(byId("own-team"), team, true);
  byId("own-weak").hidden = !weak;
  showHandicap(byId("own-handicap"), me);
  setText(box.querySelector(".life-value"), t("home.life", { life }));
  setLife(box.querySelector("[role=progressbar]"), life);
}

/** A shield over the own picture, with the seconds, while nobody can be hit. */
function showProtection(seconds) {
  const shield = byId("own-protected");
  shield.hidden = seconds === 0;
  if (shield.hidden) return;
  setText(shield.querySelector("b"), number(Math.ceil(seconds)));
  shield.title = state.protectionText(seconds);
  setText(shield.lastElementChild, shield.title);
}

function showHandicap(sign, user) {
  const text = state.handicapText(user);
  sign.hidden = text === "";
  sign.title = text;
  setText(sign.lastElementChild, text);
}

/** Make the list's children those of `users`, each kept by name; only what has changed is touched. */
function showRows(parent, users, make, fill) {
  const rows = new Map([...parent.children].map((row) => [row.dataset.name, row]));
  const wanted = users.map((user) => {
    const row = rows.get(user.name) ?? make(user.name);
    row.dataset.name = user.name;
    fill(row, user);
    return row;
  });
  const isSame = wanted.length === parent.children.length && wanted.every((row, index) => parent.children[index] === row);
  if (!isSame) parent.replaceChildren(...wanted);
}

/** In a battle of teams, the first row of each stands a little off: the referee's order keeps teams together. */
function markGroups(list, { game, teams }) {
  const isOfTeams = teams > 0 && game === state.PLAYING;
  [...list.children].forEach((row, index) => {
    const before = list.children[index - 1];
    row.classList.toggle("is-first", isOfTeams && index > 0 && before.dataset.team !== row.dataset.team);
  });
}

function makeRival(name) {
  return element(
    "li",
    { className: "rival" },
    element("img", { alt: "", width: 36, height: 36 }),
    element(
      "span",
      { className: "rival-name" },
      makeMark(),
      element("strong", { className: "user-name", title: name }, name),
      element("span", { className: "kills", hidden: true }),
      element("span", { className: "hill", hidden: true }),
      element("span", { className: "handicap", hidden: true }, icon("shield"), element("span", { className: "visually-hidden" })),
    ),
    element("span", { className: "badge" }),
    element("span", { className: "user-sign" }),
    lifeBar(t("home.life_of", { name })),
  );
}

function fillRival(row, user, game) {
  showPicture(row.querySelector("img"), user.avatar, user.robot);
  const sign = setSign(row.querySelector(".user-sign"), user, game);
  row.classList.toggle("is-out", sign === "times");
  row.dataset.team = user.team;
  showMark(row.querySelector(".team-mark"), user.team);
  showKills(row.querySelector(".kills"), game === state.PLAYING ? user.kills : 0);
  showHandicap(row.querySelector(".handicap"), user);
  const hill = game === state.PLAYING ? state.hillText(user) : "";
  row.querySelector(".hill").hidden = hill === "";
  setText(row.querySelector(".hill"), hill);
  setText(row.querySelector(".badge"), percent(user.life));
  setLife(row.querySelector(".bar"), user.life);
}

function showKills(box, kills) {
  box.hidden = kills === 0;
  const meaning = t("home.kills", { n: kills });
  if (box.title === meaning) return;
  box.title = meaning;
  box.replaceChildren(icon("hit"), element("b", { ariaHidden: "true" }, number(kills)), element("span", { className: "visually-hidden" }, meaning));
}

function makeSeat(name) {
  return element(
    "li",
    { className: "seat" },
    element("img", { alt: "", width: 72, height: 72 }),
    element("strong", { className: "user-name", title: name }, name),
    makeMark(),
    element("span", { className: "user-sign" }),
  );
}

function fillSeat(seat, user, game, name) {
  showPicture(seat.querySelector("img"), user.avatar, user.robot);
  setSign(seat.querySelector(".user-sign"), user, game);
  showMark(seat.querySelector(".team-mark"), user.team);
  seat.classList.toggle("is-ready", user.ready);
  seat.classList.toggle("is-me", user.name === name);
}

function setSign(box, user, game) {
  const { symbol, meaning } = state.userSign(user, game);
  if (box.title !== meaning) {
    box.title = meaning;
    box.dataset.sign = symbol;
    box.replaceChildren(icon(symbol), element("span", { className: "visually-hidden" }, meaning));
  }
  return symbol;
}

/** The state of the connection with its quality and, when something is wrong, the banner that says what. */
export function showConnection({ level, text, banner }, quality) {
  const box = byId("connection-state");
  box.dataset.level = level === "ok" && quality ? quality.level : level;
  setText(box.querySelector(".connection-text"), text);
  const isMeasured = level === "ok" && quality !== null;
  setText(box.querySelector(".round-trip"), isMeasured ? `${number(quality.ms)} ms` : "");
  const line = byId("banner");
  line.hidden = banner === "";
  line.dataset.level = level;
  setText(line, banner);
}

/** What the player is told of the arena's picture; empty while it lives. */
export function showArenaNote(text) {
  const note = byId("arena-note");
  note.hidden = text === "";
  setText(note, text);
}

/** Light up what is held: key caps, pad and the robot on the stage. */
export function showHeld(actions) {
  for (const node of document.querySelectorAll("[data-action]")) {
    node.classList.toggle("is-held", actions.has(node.dataset.action));
  }
  byId("pilot").dataset.held = [...actions].join(" ");
}

/** Said by screen readers. */
export function announce(text) {
  if (text) byId("announcer").textContent = text;
}
