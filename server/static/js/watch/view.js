// The elements of the page for spectators, set from the state. Nodes of people who stay are kept.

import { cheerButton } from "./audience.js";
import { avatarUrl } from "../common/assets.js";
import { element, lifeBar, setLife, setPicture, setText } from "../common/dom.js";
import { effectsText } from "../battle/effects.js";
import { wearColour } from "../common/robot_colours.js";
import { leadersView } from "../results/leaders.js";
import { podiumView } from "../results/podium.js";
import { clockText, COUNTDOWN, handicapText, hillText, PLAYING, STOPPED } from "../battle/state.js";
import { makeMark, showMark } from "../battle/team_view.js";
import { byTeam, teamsOf } from "../battle/teams.js";
import { list, percent, t } from "../common/words.js";

const QUEUE = 8; // names shown
const FEW = 6; // players; more get smaller rows
const MANY = 12; // players; more stand in two columns
const LAST = 30; // s in which the clock is red

const byId = (id) => document.getElementById(id);
const calm = matchMedia("(prefers-reduced-motion: reduce)");

/** Everything that depends on the state of the battle. @param {import("../battle/status_feed.js").WatchedStatus} status */
export function showStatus(status) {
  document.body.dataset.paused = status.paused;
  setText(byId("headline"), headline(status));
  const message = byId("message");
  message.hidden = status.message === "";
  setText(message, status.message);
  showClock(status);
  showCountdown(status);
  showPlayers(status);
  showQueue(status);
  showFree(status.free);
}

function headline({ game, paused, users, teams, protection }) {
  if (paused && game !== STOPPED) return t("watch.paused");
  if (game === COUNTDOWN) return t("watch.countdown");
  if (protection > 0) return t("watch.protected", { n: Math.ceil(protection) });
  const ready = users.filter((user) => user.ready);
  const alive = ready.filter((user) => user.life > 0);
  if (game === PLAYING && teams > 0) return t("watch.alive_teams", { n: teamsOf(alive).length });
  if (game === PLAYING) return t("watch.alive", { n: alive.length });
  return ready.length === 0 ? t("watch.idle_none") : t("watch.idle", { n: ready.length });
}

function showClock({ game, timeLeft }) {
  const clock = byId("clock");
  clock.hidden = game === STOPPED;
  if (clock.hidden) return;
  setText(clock.firstElementChild, game === PLAYING ? t("watch.time_left") : t("watch.starts_in"));
  setText(clock.lastElementChild, clockText(timeLeft));
  clock.dataset.last = game === PLAYING && timeLeft <= LAST;
}

function showCountdown({ game, timeLeft }) {
  const number = byId("countdown");
  number.hidden = game !== COUNTDOWN;
  const seconds = String(Math.ceil(timeLeft));
  if (number.hidden || number.textContent === seconds) return;
  number.textContent = seconds;
  if (calm.matches) return;
  number.animate([{ transform: "scale(1.6)", opacity: 0 }, { transform: "scale(1)", opacity: 1 }], { duration: 250, easing: "ease-out" });
}

function showPlayers({ users, game }) {
  const shown = byId("players");
  shown.dataset.size = users.length <= FEW ? "few" : users.length <= MANY ? "many" : "crowd";
  byId("nobody").hidden = users.length > 0;
  byId("next-title").hidden = game !== STOPPED || users.length === 0;
  const rows = new Map([...shown.children].map((row) => [row.dataset.name, row]));
  const ordered = game === PLAYING ? users : byTeam(users); // in a battle the referee's order keeps teams together
  const wanted = ordered.map((user, index) => {
    const row = rows.get(user.name) ?? makeRow(user.name);
    fillRow(row, user, game);
    row.classList.toggle("is-first", index > 0 && ordered[index - 1].team !== user.team);
    return row;
  });
  const isOther = wanted.length !== shown.children.length || wanted.some((row, index) => shown.children[index] !== row);
  if (isOther) shown.replaceChildren(...wanted);
}

function makeRow(name) {
  const row = element(
    "li",
    { className: "watch-player" },
    element("img", { alt: "", width: 64, height: 64 }),
    element("span", { className: "watch-who" }, makeMark(), element("strong", { className: "watch-name" }, name), element("em", { className: "watch-effects" })),
    element("span", { className: "watch-robot" }),
    element("span", { className: "watch-life" }),
    lifeBar(t("watch.life_of", { name })),
    cheerButton(name),
  );
  row.dataset.name = name;
  return row;
}

function fillRow(row, user, game) {
  const picture = row.querySelector("img");
  setPicture(picture, avatarUrl(user.avatar));
  wearColour(picture, user.robot);
  const { state, text } = standing(user, game);
  row.dataset.state = state;
  row.dataset.team = user.team;
  showMark(row.querySelector(".team-mark"), user.team);
  const robot = t("watch.robot", { n: user.robot });
  const kills = game === PLAYING && user.kills > 0 ? `, ${t("podium.kills", { n: user.kills })}` : "";
  const more = [handicapText(user), game === PLAYING && hillText(user)].filter(Boolean).map((text) => `, ${text}`);
  setText(row.querySelector(".watch-robot"), robot + kills + more.join(""));
  setText(row.querySelector(".watch-effects"), effectsText(user));
  setText(row.querySelector(".watch-life"), text);
  const bar = row.querySelector(".bar");
  bar.hidden = game !== PLAYING || !user.ready;
  setLife(bar, user.life);
}

function standing({ ready, life }, game) {
  if (game === PLAYING) {
    if (!ready) return { state: "absent", text: t("watch.not_in") };
    return life > 0 ? { state: "fighting", text: percent(life) } : { state: "out", text: t("watch.out") };
  }
  return ready ? { state: "ready", text: t("watch.ready") } : { state: "absent", text: t("watch.not_ready") };
}

function showQueue({ waiting, game }) {
  byId("queue").hidden = waiting.length === 0;
  setText(byId("queue").firstElementChild, game === STOPPED ? t("watch.then") : t("watch.next"));
  const names = waiting.slice(0, QUEUE);
  const more = waiting.length - names.length;
  setText(byId("queue-names"), more > 0 ? `${names.join(", ")} ${t("watch.more", { n: more })}` : list(names));
}

function showFree(free) {
  const line = byId("free");
  line.dataset.none = free === 0;
  setText(line, free === 0 ? t("watch.free_none") : t("watch.free", { n: free }));
}

/** What the screen has room for now. @param {import("./screen_schedule.js").Panel} panel */
export function showPanel(panel) {
  document.body.dataset.panel = panel;
  byId("join").hidden = panel === "none"; // large between battles, otherwise in the corner
  byId("leaders").hidden = panel !== "leaders";
  byId("podium").hidden = panel !== "podium";
}

/** @param {import("../battle/messages.js").Status} status at the end of a battle */
export const showPodium = ({ result, coded }) => byId("podium-view").replaceChildren(podiumView(result, null, coded));

/** @param {import("../results/leaders.js").Leader[]} players */
export const showLeaders = (players) => byId("leaders-table").replaceChildren(leadersView(players));

/** @param {import("../battle/status_feed.js").FeedState} state */
export function showConnection(state) {
  const banner = byId("banner");
  banner.hidden = state !== "lost";
  setText(banner, banner.hidden ? "" : t("watch.lost"));
}

/** What is wrong with the arena's picture, over it. @param {import("../arena/presence.js").ArenaState} state */
export function showArena(state) {
  const note = byId("arena-note");
  note.hidden = state !== "lost";
  setText(note, note.hidden ? "" : t("watch.arena_lost"));
}

/** Said by screen readers. */
export function announce(text) {
  if (text) byId("announcer").textContent = text;
}
