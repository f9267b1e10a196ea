// The home page's elements, set from the state. It keeps nothing but what is needed to change as little as possible.

import { avatarUrl } from "./assets.js";
import { element, icon, setLife, setText } from "./dom.js";
import * as effects from "./effects.js";
import * as state from "./state.js";

const byId = (id) => document.getElementById(id);

/** Names, robot, picture and date of the player, wherever the page shows them. */
export function showPlayer({ name, robot, avatar, date }) {
  const set = (selector, text) => document.querySelectorAll(selector).forEach((node) => setText(node, text));
  set(".username", name);
  set(".robotN", `Robot ${robot}`);
  set(".date", `Logged in: ${date}`);
  for (const picture of document.querySelectorAll(".userImage")) {
    if (picture.getAttribute("src") !== avatarUrl(avatar)) picture.src = avatarUrl(avatar);
  }
}

/** Everything that depends on the state of the battle; `refusal` is why commands are refused now, for people. */
export function showStatus(status, name, refusal) {
  const phase = state.phaseOf(status, name);
  const { text, hint } = state.gameText(status, name, refusal);
  document.body.dataset.phase = phase ?? "idle";
  document.body.dataset.paused = status.paused;
  const message = byId("message");
  message.hidden = status.message === "";
  setText(message, status.message);
  setText(byId("game-status"), text);
  setText(byId("game-hint"), hint);
  document.querySelector(".hud").classList.toggle("is-refused", Boolean(refusal));
  showClock(status);
  showCountdown(status);
  showReadyButton(state.readyButton(status, name));
  const me = state.findUser(status, name);
  if (me) showOwnLife(me.life);
  showOthers(status, name);
}

function showClock(status) {
  const clock = byId("clock");
  clock.hidden = status.game !== state.PLAYING;
  if (clock.hidden) return;
  setText(clock.lastElementChild, state.clockText(status.timeLeft));
  clock.dataset.last = status.timeLeft <= 30;
}

function showCountdown(status) {
  const number = byId("countdown");
  number.hidden = status.game !== state.COUNTDOWN;
  if (number.hidden) return;
  const seconds = String(Math.ceil(status.timeLeft));
  if (number.textContent === seconds) return;
  number.textContent = seconds;
  effects.count(number);
}

function showReadyButton({ ready, text, disabled }) {
  const button = byId("ready-btn");
  setText(button.querySelector("span"), text);
  button.dataset.ready = ready;
  button.setAttribute("aria-pressed", ready);
  if (disabled && document.activeElement === button) button.blur(); // a disabled button would keep the keys to itself
  button.disabled = disabled;
}

function showOwnLife(life) {
  const box = byId("userLife");
  setText(box.querySelector(".life-value"), `LIFE ${life}%`);
  setLife(box.querySelector("[role=progressbar]"), life);
}

function showOthers(status, name) {
  const list = byId("userList");
  const others = state.others(status, name);
  byId("nobody").hidden = others.length > 0;
  setText(byId("user-count"), String(status.users.length));
  const rows = new Map([...list.children].map((row) => [row.dataset.name, row]));
  const wanted = others.map((user) => {
    const row = rows.get(user.name) ?? makeRow(user.name);
    fillRow(row, user, status.game);
    return row;
  });
  if (wanted.length !== list.children.length || wanted.some((row, index) => list.children[index] !== row)) {
    list.replaceChildren(...wanted);
  }
}

function makeRow(name) {
  const bar = element("div", { className: "bar" }, element("div", { className: "bar-fill" }));
  bar.setAttribute("role", "progressbar");
  bar.setAttribute("aria-valuemin", "0");
  bar.setAttribute("aria-valuemax", "100");
  bar.setAttribute("aria-label", `Life of ${name}`);
  const row = element(
    "li",
    { className: "user" },
    element("img", { className: "user-picture", alt: "", width: 40, height: 40 }),
    element("span", { className: "user-icon" }),
    element("strong", { className: "user-name" }, name),
    element("span", { className: "user-robot" }),
    element("span", { className: "badge" }),
    bar,
  );
  row.dataset.name = name;
  return row;
}

function fillRow(row, user, game) {
  const picture = row.querySelector(".user-picture");
  if (picture.getAttribute("src") !== avatarUrl(user.avatar)) picture.src = avatarUrl(user.avatar);
  const sign = state.userIcon(user, game);
  const box = row.querySelector(".user-icon");
  if (box.title !== sign.meaning) {
    box.title = sign.meaning;
    box.style.color = sign.color;
    box.replaceChildren(icon(sign.symbol), element("span", { className: "visually-hidden" }, sign.meaning));
  }
  row.classList.toggle("is-out", sign.symbol === "times");
  setText(row.querySelector(".user-robot"), `Robot ${user.robot}`);
  setText(row.querySelector(".badge"), `${user.life}%`);
  setLife(row.querySelector(".bar"), user.life);
}

/** The state of the connection and, when something is wrong, the banner that says what. */
export function showConnection({ level, text, banner }) {
  const box = byId("connection-state");
  box.dataset.level = level;
  setText(box.querySelector("span"), text);
  const line = byId("banner");
  line.hidden = banner === "";
  line.dataset.level = level;
  setText(line, banner);
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

/** The ranking as a list for a dialog. */
export function rankingList(rows) {
  return element(
    "div",
    { className: "ranking" },
    element("p", { className: "label" }, "Ranking:"),
    element(
      "ol",
      {},
      ...rows.map((row) =>
        element(
          "li",
          { className: row.isMe ? "is-me" : "", value: row.place },
          element("span", { className: "place" }, `${row.place}`),
          element("img", { src: avatarUrl(row.avatar), alt: "", width: 32, height: 32 }),
          element("strong", {}, row.name),
          element("span", { className: "note" }, row.note),
        ),
      ),
    ),
  );
}
