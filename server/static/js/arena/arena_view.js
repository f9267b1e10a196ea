// The arena from above on a page: drawn from /positions and /shots, which the page's connection to rosbridge brings, and
// from the battle's state. docs/protocol-browser.md, "The picture of the arena".

import { t } from "../common/words.js";
import { arenaPlayers } from "../battle/players.js";
import { Covered } from "./covered.js";
import { inWords } from "./in_words.js";
import { Motion } from "./motion.js";
import { Picture } from "./picture.js";
import { readPositions } from "./positions.js";
import { Presence } from "./presence.js";
import { MARGIN } from "./scene.js";
import { Shooting } from "./shooting.js";

const TICK = 500; // ms between two looks at whether positions come
const RATE = 60; // ms between two positions at least; the newest waits

/** @typedef {import("./presence.js").ArenaState} ArenaState */

const seconds = () => performance.now() / 1000;

export class ArenaView {
  #box;
  #onState;
  #onFrame;
  #picture;
  #motion = new Motion();
  #shooting = new Shooting();
  #presence = new Presence(performance.now());
  #robots = []; // the newest
  #covered = new Covered();
  #floor = ""; // as text
  #state = "connecting"; // that was told

  /**
   * @param {HTMLElement} box with a <canvas> and a <p> for an empty floor; hidden until there is something to see
   * @param {(state: ArenaState) => void} onState on each change
   * @param {(frame: import("../overhead/rectify.js").Frame) => void} [onFrame] what the picture shows, on each change
   */
  constructor(box, onState, onFrame = () => {}) {
    this.#box = box;
    this.#onState = onState;
    this.#onFrame = onFrame;
    const words = { you: t("game.you"), hit: t("arena.hit") };
    this.#picture = new Picture(box.querySelector("canvas"), (now) => this.#shooting.on(this.#motion.at(now), now), words);
    setInterval(() => {
      this.#presence.look(performance.now());
      this.#become();
    }, TICK);
  }

  /** What the page's connection to rosbridge is to bring. @type {import("../drive/connection.js").Topic[]} */
  topics = [
    {
      topic: "/positions", type: "laser_bot_battle/Positions", throttle_rate: RATE, queue_length: 1,
      take: (message) => this.#see(message),
    },
    { topic: "/overhead/covered", type: "laser_bot_battle/OverheadCovered", take: ({ robots }) => this.#covered.hear(robots, performance.now()) },
    { topic: "/shots", type: "laser_bot_battle/Shot", take: ({ robot }) => this.#shoot(robot) },
  ];

  /**
   * A new state of the battle has arrived.
   * @param {import("../battle/messages.js").Status} status
   * @param {string|null} me this page's player; null for a spectator
   */
  take(status, me) {
    if (this.#shooting.take(status)) this.#picture.wake();
    this.#picture.show(arenaPlayers(status, me));
    this.#picture.places = status.places;
    this.#showWords();
  }

  /** At how much of its size the page shows the picture. @param {number} scale */
  set scale(scale) {
    this.#picture.scale = scale;
  }

  /** What is under the robots instead of the drawn floor: the frame. @param {OffscreenCanvas|null} picture */
  set realFloor(picture) {
    this.#picture.realFloor = picture;
  }

  /** Another picture of the page is being drawn beside the arena's. */
  join() {
    this.#picture.join();
  }

  #see(message) {
    const seen = readPositions(message, this.#covered.at(performance.now()));
    if (!seen) return;
    this.#presence.hear(performance.now());
    this.#become();
    this.#motion.add(seen.robots, seconds());
    const floor = JSON.stringify(seen.floor);
    if (floor !== this.#floor) {
      this.#floor = floor;
      this.#motion.clear();
      this.#motion.add(seen.robots, seconds());
      this.#picture.build(seen.floor);
      const { width, height } = seen.floor;
      this.#onFrame({ left: -MARGIN, bottom: -MARGIN, right: width + MARGIN, top: height + MARGIN });
    }
    const before = this.#robots;
    this.#robots = seen.robots;
    if (JSON.stringify(before) !== JSON.stringify(seen.robots)) this.#picture.wake();
    if (before.map(({ id }) => id).join() !== seen.robots.map(({ id }) => id).join()) this.#showWords();
  }

  #shoot(robot) {
    this.#shooting.shoot(robot, seconds());
    this.#picture.wake();
  }

  #become() {
    const { state } = this.#presence;
    if (state === this.#state) return;
    this.#state = state;
    this.#box.hidden = !["live", "lost"].includes(state);
    this.#box.dataset.state = state;
    this.#onState(state);
  }

  /** The picture in words, for those who do not see it. */
  #showWords() {
    const [canvas, empty] = this.#box.children;
    empty.hidden = this.#robots.length > 0;
    const label = inWords(this.#robots, (robot) => this.#picture.roles.of(robot)?.player);
    if (canvas.ariaLabel !== label) canvas.ariaLabel = label;
  }
}
