// The entrance to several arenas.

import { element, setText } from "../common/dom.js";
import { knownName } from "../common/known_name.js";
import { connectPreferences } from "../common/preferences.js";
import { Who } from "../common/who.js";
import { t } from "../common/words.js";
import { arenaUrl, countsText, problemText, stateText, summaryText } from "./arenas.js";

const POLL = 5000; // ms between two questions; a page that nobody looks at asks nothing
const TIMEOUT = 4000; // ms

const form = document.getElementById("login");
const problem = document.getElementById("problem");
const list = document.getElementById("arenas");

const who = new Who(knownName(document.cookie));
const rows = new Map(); // by the arena's name
let busy = false;
let timer = 0;

/** Go to the arena called `arena`, or with "" to whichever has a robot next. */
async function play(arena) {
  if (busy || !who.check()) return;
  busy = true;
  const reply = await ask("/play", {
    method: "POST",
    body: new URLSearchParams({ name: who.name, avatar: who.avatar, arena }),
  }).catch(() => ({ status: "NO_ANSWER" }));
  busy = reply.status === "OK"; // until the next page is there
  problem.hidden = busy;
  if (busy) location.assign(arenaUrl(reply.address, location.hostname));
  else setText(problem, problemText(reply.status));
}

async function ask(route, options) {
  const response = await fetch(route, { ...options, signal: AbortSignal.timeout(TIMEOUT) });
  return response.json();
}

/** An arena keeps its place and its buttons: nothing moves under a finger, nor loses the focus. */
function row(name) {
  if (!rows.has(name)) {
    const parts = { state: element("span", { className: "state" }), counts: element("p", { className: "counts" }) };
    const here = element("button", { type: "button", className: "button quiet" }, t("entrance.play_here"));
    const watch = element("a", { className: "button quiet" }, t("entrance.watch"));
    here.setAttribute("aria-label", t("entrance.play_in", { name }));
    watch.setAttribute("aria-label", t("entrance.watch_in", { name }));
    here.addEventListener("click", () => play(name));
    const buttons = element("div", { className: "buttons" }, here, watch);
    const item = element("li", { className: "panel hall" }, element("h3", {}, name), parts.state, parts.counts, buttons);
    list.append(item);
    rows.set(name, { ...parts, item, buttons, watch });
  }
  return rows.get(name);
}

function show(arenas) {
  setText(document.getElementById("summary"), summaryText(arenas));
  for (const arena of arenas) {
    const { item, state, counts, buttons, watch } = row(arena.name);
    item.dataset.state = arena.state;
    item.dataset.free = String(arena.state === "stopped" && arena.free > 0);
    buttons.hidden = arena.state === "away";
    watch.href = `${arenaUrl(arena.address, location.hostname)}/watch`;
    setText(state, stateText(arena));
    setText(counts, countsText(arena));
  }
  for (const [name, { item }] of rows) {
    if (arenas.some((arena) => arena.name === name)) continue;
    item.remove();
    rows.delete(name);
  }
}

async function follow() {
  clearTimeout(timer);
  if (document.hidden) return;
  const told = await ask("/arenas.json", {}).catch(() => null);
  document.getElementById("connection-state").hidden = told !== null;
  if (told) show(told.arenas);
  clearTimeout(timer);
  timer = setTimeout(follow, POLL);
}

form.addEventListener("submit", (event) => {
  event.preventDefault();
  play("");
});
document.addEventListener("visibilitychange", follow);
addEventListener("pageshow", (event) => event.persisted && location.reload()); // back from an arena

connectPreferences();
follow();
