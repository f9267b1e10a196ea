// The page of the arena: follows the view's WebSocket, draws every frame.

import { Feed } from "./feed.js";
import { Motion } from "./motion.js";
import { showRobots } from "./roster.js";
import { Scene } from "./scene.js";

const canvas = document.getElementById("floor");
const connection = document.getElementById("connection");
const empty = document.getElementById("empty");
const roster = document.getElementById("robots");

const CONNECTION_TEXT = { connecting: "connecting", live: "live", lost: "the arena does not answer, trying again" };

// inside another page: only the floor
if (new URLSearchParams(location.search).has("embedded")) document.body.classList.add("embedded");

const scene = new Scene(canvas);
const motion = new Motion();

function showConnection(state) {
  connection.dataset.state = document.body.dataset.connection = state;
  connection.textContent = CONNECTION_TEXT[state];
}

function receive(message) {
  if (message.type === "arena") {
    document.body.style.setProperty("--floor-ratio", `${message.width} / ${message.height}`);
    scene.build(message);
    motion.clear();
  } else if (message.type === "state") {
    motion.add(message, performance.now() / 1000);
    showRobots(roster, message.robots);
    empty.hidden = message.robots.length > 0;
  }
}

function frame(milliseconds) {
  const now = milliseconds / 1000;
  scene.draw(motion.at(now), now);
  requestAnimationFrame(frame);
}

const scheme = location.protocol === "https:" ? "wss:" : "ws:";
new Feed(`${scheme}//${location.host}/view`, receive, showConnection).open();
new ResizeObserver(() => scene.resize()).observe(canvas.parentElement);
requestAnimationFrame(frame);
