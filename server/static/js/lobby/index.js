// The login page.

import { ArenaView } from "../arena/arena_view.js";
import { socketAddress } from "../common/addresses.js";
import * as api from "../common/api.js";
import * as dialogs from "../common/dialogs.js";
import { setText } from "../common/dom.js";
import { help } from "../common/help.js";
import { vibrate } from "../common/jolt.js";
import { knownName, playOnce } from "../common/known_name.js";
import { OfferCall } from "./call.js";
import { loginDialog } from "./login.js";
import { connectAsking, notify } from "./notices.js";
import { connectPreferences } from "../common/preferences.js";
import { Preferences } from "../common/preferences_store.js";
import { OwnTournament } from "../battle/own_tournament.js";
import { battleText, queueText } from "../battle/queue.js";
import { StatusFeed } from "../battle/status_feed.js";
import { Speaker } from "../common/speaker.js";
import * as storage from "../common/storage.js";
import { Who } from "../common/who.js";
import { t } from "../common/words.js";

const POLL = 1000; // ms between two questions for free robots

const form = document.getElementById("login");
const robots = document.getElementById("availableR");
const message = document.getElementById("message");
const choice = document.getElementById("robot");
const connectionState = document.getElementById("connection-state");

const queue = document.getElementById("queue");
const take = document.getElementById("take");

const speaker = new Speaker(new Preferences());
const call = new OfferCall({ speaker, vibrate, page: document, notify });

// behind the page, where something tells where the robots are
const arena = new ArenaView(document.getElementById("arena"), (state) => document.body.classList.toggle("has-arena", state === "live"));

const guest = knownName(document.cookie); // of another arena or the entrance
const who = new Who(guest);
let entered = false; // the page goes
let busy = false;
let tournament = null; // of whoever waits

/** Sign up and go to the battle. The reply, also where the page itself says no. */
async function logIn() {
  if (!storage.isAvailable()) return { status: "NO_STORAGE" };
  const reply = await api.signUp(who.name, who.avatar, choice.value).catch(() => ({ status: "NO_ANSWER" }));
  if (reply.status === "OK") enter(reply);
  else if (reply.status === "QUEUED") waitForRobot();
  return reply;
}

/** Go to the own robot. Whoever takes an offer may hear of it twice before the page has gone. */
function enter({ user, robot }) {
  if (entered) return;
  entered = true;
  call.end();
  storage.save(user, robot, who.avatar, new Date());
  location.assign("/home");
}

/** Show the queue until there is a robot, or the visitor goes. */
async function waitForRobot() {
  const clock = new Worker(document.querySelector("meta[name=second]").content);
  const second = () => new Promise((resolve) => (clock.onmessage = resolve));
  for (;;) {
    const session = await api.session().catch(() => null);
    if (session?.status === "OK") return enter(session);
    if (session?.status === "UNREGISTERED") break;
    if (session) showQueue(session);
    await second();
  }
  clock.terminate();
  tournament = null;
  call.end();
  if (!take.hidden) {
    dialogs.show({ kind: "info", title: t("login.gone"), text: t("login.gone_text") });
  }
  document.body.classList.remove("is-queued");
  queue.hidden = true;
  take.hidden = true;
  who.focus();
}

function showQueue(session) {
  const words = queueText(session);
  tournament ??= new OwnTournament(session.user, document.getElementById("queue-tournament"));
  queue.hidden = false;
  document.body.classList.add("is-queued");
  setText(document.getElementById("queue-title"), words.title);
  setText(document.getElementById("queue-text"), words.text);
  const isNew = take.hidden && session.offer !== null;
  take.hidden = session.offer === null;
  if (isNew) take.focus();
  if (take.hidden) call.end();
  else call.call(words, performance.now());
}

/** What there is to see meanwhile: who is who in the arena, and who fights. */
function showBattle(status) {
  arena.take(status, null);
  tournament?.take(status);
  setText(document.getElementById("queue-battle"), battleText(status));
}

/** A player who is still signed in from this browser may go on, or give the robot back. What the server no longer knows is forgotten. */
async function offerRestore() {
  const session = await api.session().catch(() => null);
  if (!session || busy) return;
  if (session.status === "QUEUED") {
    who.name = session.user;
    waitForRobot();
    return;
  }
  if (session.status !== "OK") {
    storage.forget();
    if (guest?.plays) form.requestSubmit();
    return;
  }
  if (guest?.plays && session.user === guest.name) {
    enter(session);
    return;
  }
  setText(document.getElementById("restore-title"), t("login.restore", { name: session.user }));
  setText(document.getElementById("restore-text"), t("login.restore_text", { id: String(session.robot) }));
  showRestore(true);
  document.getElementById("go-on").focus();
  document.getElementById("sign-out").addEventListener("click", async () => {
    await api.signOut(session.user).catch(() => null);
    storage.forget();
    showRestore(false);
    who.focus();
  });
}

function showRestore(is) {
  document.getElementById("restore").hidden = !is;
  document.body.classList.toggle("is-restored", is);
}

/** Offer the `free` robots, and any of them. One that is chosen and gone is offered on: only the server says no. */
function showChoice(free) {
  const chosen = choice.value;
  const ids = chosen === "" ? free : [...new Set([...free, Number(chosen)])].sort((one, other) => one - other);
  const options = ids.map((id) => new Option(t("login.robot", { id: String(id) }), String(id)));
  const shown = [...choice.options].slice(1).map((option) => option.value);
  if (shown.join() !== ids.join()) choice.replaceChildren(choice.options[0], ...options);
  choice.value = chosen;
  choice.parentElement.hidden = ids.length < 2 && chosen === "";
}

async function showRobots() {
  try {
    const reply = await api.availableRobots();
    const n = reply.availableR;
    setText(robots, n > 0 ? t("login.free", { n }) : t("login.none_free"));
    robots.dataset.none = n === 0;
    robots.dataset.count = n;
    showChoice(reply.robots);
    message.hidden = reply.message === "";
    setText(message, reply.message);
    connectionState.hidden = true;
  } catch {
    connectionState.hidden = false;
  }
  setTimeout(showRobots, POLL);
}

form.addEventListener("submit", async (event) => {
  event.preventDefault();
  if (busy || !who.check()) return;
  busy = true;
  const reply = await logIn();
  if (reply.status === "OK") return; // busy until the next page is there
  busy = false; // before the dialog: its end is told late, and Enter must count as soon as it is gone
  if (reply.status === "QUEUED") return;
  if (reply.status === "ROBOT_UNAVAILABLE") choice.value = "";
  dialogs.show(loginDialog(reply));
});
take.addEventListener("click", async () => {
  const reply = await api.takeRobot().catch(() => null);
  if (reply?.status === "OK") enter(reply);
});
document.getElementById("leave").addEventListener("click", async () => {
  take.hidden = true; // it is the visitor's own wish
  call.end();
  await api.signOut(who.name).catch(() => null);
});
document.getElementById("how-to").addEventListener("click", help);
addEventListener("pagehide", () => call.end()); // a notice would outlive the page
addEventListener("pageshow", (event) => event.persisted && location.reload()); // back from home: all may have changed

if (guest?.plays) playOnce(document.querySelector("meta[name=domain]")?.content);
connectPreferences();
connectAsking(document.getElementById("tell"), document.getElementById("told"));
speaker.listen(window);
new StatusFeed({ url: socketAddress("rosbridge"), onStatus: showBattle, onState: () => {}, topics: arena.topics }).start();
showRobots();
offerRestore();
