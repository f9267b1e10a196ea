// The page of one battle: shows its replay on the arena's floor, and how it ended in the reader's language.

import { element, setText } from "../common/dom.js";
import { showMoments } from "../common/local_times.js";
import { noticeText } from "../common/notice.js";
import { connectPreferences } from "../common/preferences.js";
import { wearColour } from "../common/robot_colours.js";
import { clock, fighterAt, lengthOf, poseAt } from "./replay.js";
import { t } from "../common/words.js";

const RADIUS = 0.075; // m, about a robot's
const MARGIN = 0.03; // m around the floor: walls have a width

const byId = (id) => document.getElementById(id);

/** An element of SVG with these attributes. */
function shape(tag, attributes, ...children) {
  const made = document.createElementNS("http://www.w3.org/2000/svg", tag);
  for (const [name, value] of Object.entries(attributes)) made.setAttribute(name, value);
  made.append(...children);
  return made;
}

/** The floor with its robots; y goes up there, and down in the picture. */
class Floor {
  #battle;
  #box;
  #robots;

  constructor(battle, box) {
    this.#battle = battle;
    this.#box = box;
    const { width, height, walls } = battle.track.floor;
    const [across, down] = [width + 2 * MARGIN, height + 2 * MARGIN];
    box.style.setProperty("--ratio", across / down);
    this.#robots = battle.fighters.map((fighter) => {
      const body = shape(
        "g",
        { class: "robot" },
        shape("circle", { r: RADIUS * 1.6, class: "flash" }),
        shape("circle", { r: RADIUS, class: "hull" }),
        shape("path", { d: `M${RADIUS * 0.85} 0L${-RADIUS * 0.5} ${RADIUS * 0.6}V${-RADIUS * 0.6}Z`, class: "nose" }),
      );
      const life = element("b");
      const label = element("p", {}, element("span", { textContent: fighter.name }), life);
      for (const node of [body, label]) wearColour(node, fighter.robot);
      return { fighter, body, label, life };
    });
    const lines = walls.map(([x1, y1, x2, y2]) => `M${x1} ${height - y1}L${x2} ${height - y2}`);
    const picture = shape(
      "svg",
      { viewBox: `${-MARGIN} ${-MARGIN} ${across} ${down}`, "aria-hidden": "true" },
      shape("path", { d: lines.join(""), class: "wall" }),
      ...this.#robots.map(({ body }) => body),
    );
    box.replaceChildren(picture, ...this.#robots.map(({ label }) => label));
  }

  show(at) {
    for (const robot of this.#robots) this.#showRobot(robot, at);
  }

  #showRobot({ fighter, body, label, life }, at) {
    const { track, timeline } = this.#battle;
    const pose = poseAt(track, fighter.robot, at);
    body.style.display = pose ? "" : "none";
    label.hidden = !pose;
    if (!pose) return;
    const { width, height } = track.floor;
    const state = fighterAt(timeline, fighter.name, at);
    body.setAttribute("transform", `translate(${pose.x} ${height - pose.y}) rotate(${-pose.heading})`);
    const below = pose.y > 0.8 * height; // the label, so that it stays within the floor
    const top = height - pose.y + (below ? 1.3 : -1.3) * RADIUS;
    const left = (100 * (pose.x + MARGIN)) / (width + 2 * MARGIN);
    const half = (50 * label.offsetWidth) / this.#box.clientWidth;
    label.style.left = `${Math.max(half, Math.min(left, 100 - half))}%`;
    label.style.top = `${(100 * (top + MARGIN)) / (height + 2 * MARGIN)}%`;
    label.style.transform = `translate(-50%, ${below ? 0 : -100}%)`;
    for (const node of [body, label]) {
      node.classList.toggle("hit", state.hit);
      node.classList.toggle("out", state.out);
    }
    setText(life, String(state.life));
  }
}

/** Time, the button and the slider. */
class Player {
  #floor;
  #length;
  #at = 0;
  #last = 0; // ms of the frame before
  #next = null; // the frame that was asked for, null while nothing plays

  constructor(battle) {
    this.#floor = new Floor(battle, byId("replay-floor"));
    this.#length = lengthOf(battle);
    byId("replay-time").max = this.#length;
    byId("replay-play").addEventListener("click", () => (this.#next === null ? this.play() : this.#pause()));
    byId("replay-time").addEventListener("input", (event) => {
      this.#at = Number(event.target.value);
      this.#show();
    });
    new ResizeObserver(() => this.#show()).observe(byId("replay-floor")); // at first, and names need other places then
  }

  play() {
    if (this.#at >= this.#length) this.#at = 0;
    this.#last = performance.now();
    setText(byId("replay-play"), t("replay.pause"));
    this.#ask();
  }

  #ask() {
    this.#next = requestAnimationFrame((now) => this.#frame(now));
  }

  #pause() {
    cancelAnimationFrame(this.#next);
    this.#next = null;
    setText(byId("replay-play"), t("replay.play"));
  }

  #frame(now) {
    this.#at = Math.min(this.#at + Math.max(0, now - this.#last) / 1000, this.#length);
    this.#last = now;
    this.#show();
    if (this.#at >= this.#length) this.#pause();
    else this.#ask();
  }

  #show() {
    const slider = byId("replay-time");
    const text = t("replay.clock", { at: clock(this.#at), length: clock(this.#length) });
    slider.value = this.#at;
    slider.setAttribute("aria-valuetext", text);
    setText(byId("replay-clock"), text);
    this.#floor.show(this.#at);
  }
}

/** Play as soon as it can be seen, unless things that move are unwelcome. */
function playWhenSeen(player, box) {
  if (matchMedia("(prefers-reduced-motion: reduce)").matches) return;
  const observer = new IntersectionObserver(
    (entries) => {
      if (!entries.some((entry) => entry.isIntersecting)) return;
      observer.disconnect();
      player.play();
    },
    { threshold: 0.6 },
  );
  observer.observe(box);
}

async function showReplay(box) {
  const response = await fetch(box.dataset.battle);
  const battle = response.ok ? await response.json() : {};
  if (!battle.track) return;
  box.hidden = false;
  playWhenSeen(new Player(battle), byId("replay-floor"));
}

/** The server says in English why the battle ended. */
function translateEnd(node) {
  const text = noticeText(node.textContent);
  if (text === node.textContent) return;
  node.textContent = text;
  node.removeAttribute("lang");
}

connectPreferences();
showMoments();
if (byId("notice")) translateEnd(byId("notice"));
if (byId("replay")) showReplay(byId("replay"));
