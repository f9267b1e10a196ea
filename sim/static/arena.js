// The page of the arena, by itself or inside a page of the game: follows the view and who plays, draws what moves.

import { Cast } from "./cast.js";
import { Embedding } from "./embedding.js";
import { Feed } from "./feed.js";
import { Game } from "./game.js";
import { Governor } from "./governor.js";
import { Motion } from "./motion.js";
import { rows, showRows } from "./roster.js";
import { Scene } from "./scene.js";
import { languageOf, wordsOf } from "./words.js";

const byId = (id) => document.getElementById(id);
const SETTLING = 3; // s that a picture moves on when nothing new happens: tracks fade, sparks fly
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
const cast = new Cast(words);
const feed = new Feed(`${scheme}//${location.host}${location.pathname}view`, receive, showConnection);
const embedding = new Embedding(takePlayers, report);

let robots = []; // of the newest state
let state = "connecting";
let told = ""; // the robots of the newest state, as text
let toldPlayers = ""; // who plays, as text
let movedAt = 0; // s; when something new was last seen
let pictures = 0; // that the screen has had time for since the last report
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
    movedAt = seconds();
  } else if (message.type === "state") {
    motion.add(message, seconds());
    robots = message.robots;
    const news = JSON.stringify(robots);
    if (news === told) return;
    told = news;
    movedAt = seconds();
    showWords();
  }
}

function takePlayers(players) {
  cast.take(players, seconds());
  governor.mode = players?.effects ?? "auto";
  feed.drives = cast.drives;
  const news = JSON.stringify(players);
  if (news === toldPlayers) return;
  toldPlayers = news;
  movedAt = seconds();
  showWords();
}

function showWords() {
  byId("empty").hidden = robots.length > 0;
  byId("empty").textContent = cast.words.empty;
  const list = rows(robots, cast, words);
  if (!isEmbedded) showRows(byId("robots"), list);
  const label = [words.picture, ...list.map(({ name, state: life }) => `${name} ${life}`.trim())].join(", ");
  if (byId("floor").getAttribute("aria-label") !== label) byId("floor").setAttribute("aria-label", label);
}

function report() {
  const now = performance.now();
  const fps = Math.round((1000 * pictures) / Math.max(1, now - reportedAt));
  [pictures, reportedAt] = [0, now];
  return { state, fps, effects: governor.level };
}

function frame(now) {
  governor.picture(now);
  pictures += 1;
  requestAnimationFrame(frame);
  const { effects } = governor;
  const isMoving = now / 1000 - movedAt < SETTLING || (cast.smokes && effects.smoke > 0 && !calm.matches);
  if (!isMoving || pictures % effects.every > 0) return;
  scene.draw(motion.at(now / 1000), cast, effects, calm.matches, now / 1000);
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
  movedAt = seconds();
}).observe(byId("floor").parentElement);
requestAnimationFrame(frame);
