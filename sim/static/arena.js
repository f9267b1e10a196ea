// The simulator's own page, for developers: what is true on the floor, drawn as on the players' pages.

import { Motion } from "../drawing/motion.js";
import { Picture } from "../drawing/picture.js";

const RETRY = 250; // ms
const seconds = () => performance.now() / 1000;

const motion = new Motion();
const picture = new Picture(document.querySelector("canvas"), (now) => motion.at(now), { you: "", hit: "HIT" });
let told = ""; // the newest robots, as text

function receive(message) {
  if (message.type === "arena") {
    picture.build(message);
    return;
  }
  motion.add(message.robots, seconds());
  const news = JSON.stringify(message.robots);
  if (news !== told) picture.wake();
  told = news;
}

function open() {
  const socket = new WebSocket(new URL("view", location.href.replace("http", "ws")));
  socket.onopen = () => document.body.classList.remove("lost");
  socket.onmessage = ({ data }) => receive(JSON.parse(data));
  socket.onclose = () => {
    document.body.classList.add("lost");
    setTimeout(open, RETRY);
  };
}

open();
