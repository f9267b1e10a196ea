// The page of the arena, by itself or inside a page of the game: follows the view and who plays, draws what moves.

import { Roles } from "./roles.js";
import { Embedding } from "./embedding.js";
import { Feed } from "./feed.js";
import { Game } from "./game.js";
import { Governor } from "./governor.js";
import { Loop } from "./loop.js";
import { Motion } from "./motion.js";
import { MOTION, REST } from "./pace.js";
import { hasGpu } from "./rendering.js";
import { rows, showRows } from "./roster.js";
import { Scene } from "./scene.js";
import { languageOf, wordsOf } from "./words.js";

const byId = (id) => document.getElementById(id);
const SETTLING = 0.5; // s after the last news until the picture, which is a bit behind, shows it
const BY_SOFTWARE = 30; // pictures a second where the computer's processor draws, which the page and the robots need, too
const calm = matchMedia("(prefers-reduced-motion: reduce)");
const isEmbedded = new URLSearchParams(location.search).has("embedded") && window.parent !== window;
const scheme = location.protocol === "https:" ? "wss:" : "ws:";
const seconds = () => performance.now() / 1000;

document.documentElement.lang = languageOf(navigator.languages);
const words = wordsOf(document.documentElement.lang);
for (const element of document.querySelectorAll("[data-word]")) element.textContent = words[element.dataset.word];
byId("side").setAttribute("aria-label", words.robots);
document.body.classList.toggle("embedded", isEmbedded);

const scene = new Scene(byId("floor"));
const motion = new Motion();
const governor = new Governor();
const roles = new Roles(words);
const feed = new Feed(`${scheme}//${location.host}${location.pathname}view`, receive, showConnection);
const embedding = new Embedding(takePlayers, report);
const loop = new Loop({ look, draw });
const most = hasGpu() ? MOTION : BY_SOFTWARE; // pictures a second

let robots = []; // of the newest state
let state = "connecting";
let told = ""; // the robots of the newest state, as text
let toldPlayers = ""; // who plays, as text
let shown = ""; // the words on the page, as text
let scale = 1; // at which the page around shows the picture
let newsAt = 0; // s; when something new was last heard of
let pictures = 0; // drawn since the last report
let reportedAt = performance.now();

function showConnection(news) {
  if (state === news) return;
  state = news;
  byId("connection").dataset.state = document.body.dataset.connection = state;
  byId("connection").textContent = words[state];
  if (isEmbedded) embedding.tell();
}

function receive(message) {
  if (message.type === "arena") {
    document.body.style.setProperty("--floor-ratio", `${message.width} / ${message.height}`);
    scene.build(message);
    motion.clear();
    wake();
  } else if (message.type === "state") {
    motion.add(message, seconds());
    robots = message.robots;
    const news = JSON.stringify(robots);
    if (news === told) return;
    told = news;
    wake();
    showWords();
  }
}

function takePlayers(players) {
  roles.take(players, seconds());
  governor.mode = players?.effects ?? "auto";
  feed.drives = roles.drives;
  const news = JSON.stringify(players);
  if (news === toldPlayers) return;
  toldPlayers = news;
  scale = players?.scale ?? 1;
  scene.renew();
  wake();
  showWords();
}

/** The words of the page; states come 25 times a second, and seldom change one. */
function showWords() {
  const list = rows(robots, roles, words);
  const news = JSON.stringify([list, roles.words.empty]);
  if (news === shown) return;
  shown = news;
  byId("empty").hidden = list.length > 0;
  byId("empty").textContent = roles.words.empty;
  if (!isEmbedded) showRows(byId("robots"), list);
  const label = [words.picture, ...list.map(({ name, state: life }) => `${name} ${life}`.trim())].join(", ");
  byId("floor").setAttribute("aria-label", label);
}

function report() {
  const now = performance.now();
  const fps = Math.round((1000 * pictures) / Math.max(1, now - reportedAt));
  [pictures, reportedAt] = [0, now];
  return { state, fps, effects: governor.level };
}

function wake() {
  newsAt = seconds();
  loop.wake();
}

function look(now, isFirst, waited) {
  if (isFirst) governor.rest();
  governor.picture(now, waited);
}

/** A picture is due at `now` (ms). @returns {number|null} ms until the next, null before there is news */
function draw(now) {
  const { effects } = governor;
  const time = now / 1000;
  const { isDrawn, pace } = scene.show(motion.at(time), roles, effects, calm.matches, time);
  if (isDrawn) pictures += 1;
  const wanted = Math.min(most * scale, effects.pictures, time - newsAt < SETTLING ? MOTION : pace);
  return wanted === REST ? null : 1000 / wanted;
}

if (isEmbedded) {
  embedding.start();
} else {
  const content = (name) => document.querySelector(`meta[name=${name}]`)?.content;
  // the game is at the same address, or at another port
  const rosbridge = content("front") ? `${location.host}/rosbridge` : `${location.hostname}:${content("rosbridge-port")}`;
  new Game(`${scheme}//${rosbridge}`, takePlayers).open();
}
feed.open();
new ResizeObserver(([{ contentRect }]) => {
  scene.resize(contentRect.width, contentRect.height);
  wake();
}).observe(byId("floor").parentElement);
