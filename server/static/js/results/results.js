// The page of one battle: shows its replay on the arena's floor, and how it ended in the reader's language.

import { DIMENSIONS } from "../arena/dimensions.js";
import { inWords } from "../arena/in_words.js";
import { Picture } from "../arena/picture.js";
import { MARGIN } from "../arena/scene.js";
import { setText } from "../common/dom.js";
import { showMoments } from "../common/local_times.js";
import { noticeText } from "../common/notice.js";
import { connectPreferences } from "../common/preferences.js";
import { clock, lengthOf, newsAt, placesAt, playersAt, pointsAt, robotsAt } from "./replay.js";
import { t } from "../common/words.js";

const byId = (id) => document.getElementById(id);

/** The floor with its robots, as on the pages of a battle that runs. */
class Floor {
  #battle;
  #canvas;
  #picture;
  #at = 0;

  constructor(battle, box) {
    this.#battle = battle;
    const { width, height } = battle.track.floor;
    box.style.setProperty("--ratio", (width + 2 * MARGIN) / (height + 2 * MARGIN));
    this.#canvas = box.querySelector("canvas");
    this.#picture = new Picture(this.#canvas, () => robotsAt(battle, this.#at), { you: "", hit: t("arena.hit") });
    this.#picture.build({ ...battle.track.floor, ...DIMENSIONS });
  }

  show(at) {
    this.#at = at;
    this.#picture.show(playersAt(this.#battle, at));
    this.#picture.places = placesAt(this.#battle, at);
    this.#picture.wake();
    const label = inWords(robotsAt(this.#battle, at), (robot) => this.#picture.roles.of(robot)?.player);
    if (this.#canvas.ariaLabel !== label) this.#canvas.ariaLabel = label;
  }
}

/** What happened, in the words of the page's table; empty if it was later than the page. */
function inTable(place) {
  const row = document.querySelectorAll("#happened tbody tr")[place];
  return row ? `${row.cells[1].textContent}: ${row.cells[2].textContent}` : "";
}

/** Time, the button and the slider. */
class Player {
  #battle;
  #floor;
  #length;
  #at = 0;
  #last = 0; // ms of the frame before
  #next = null; // the frame that was asked for, null while nothing plays

  constructor(battle) {
    this.#battle = battle;
    this.#floor = new Floor(battle, byId("replay-floor"));
    this.#length = lengthOf(battle);
    byId("replay-time").max = this.#length;
    byId("replay-play").addEventListener("click", () => (this.#next === null ? this.play() : this.#pause()));
    byId("replay-time").addEventListener("input", (event) => {
      this.#at = Number(event.target.value);
      this.#show();
    });
    this.#show();
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
    setText(byId("replay-news"), newsAt(this.#battle, this.#at).map(inTable).filter(Boolean).join(" · "));
    const points = [...pointsAt(this.#battle, this.#at)].map(([name, n]) => t("replay.points", { name, n }));
    setText(byId("replay-points"), points.join(" · "));
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
