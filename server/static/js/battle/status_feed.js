// The state of the battle for who only watches: rosbridge's /game_status, and the server's /watch.json while rosbridge has
// no place or does not answer. It says nothing of this browser's player.

import { watchedStatus } from "../common/api.js";
import { subscription } from "../drive/connection.js";
import { fromTopic } from "./messages.js";

// As often as people can follow. The newest state waits, so that none is lost.
const SUBSCRIPTION = {
  op: "subscribe",
  id: "status",
  topic: "/game_status",
  type: "laser_bot_battle/GameStatus",
  throttle_rate: 200, // ms
  queue_length: 1,
};
const SILENCE = 4000; // ms; the state comes every 500 ms at least, so such a connection is half-open
const RETRY = 250; // ms to the second attempt; each later one takes twice as long
const MOST_RETRY = 15_000; // ms
const POLL = 2000; // ms between two questions by HTTP
const LOST_AFTER = 2; // questions in a row without an answer

/**
 * @typedef {import("./messages.js").Status & {waiting: string[], free: number}} WatchedStatus
 *   `waiting`: who waits for a robot, the next one first; `free`: how many robots nobody drives
 * @typedef {"connecting"|"live"|"lost"} FeedState
 */

/** @returns {WatchedStatus} from a laser_bot_battle/GameStatus */
const read = (message) => ({ ...fromTopic(message), waiting: message.queue, free: message.available_robots });

const browser = {
  open: (url) => new WebSocket(url),
  ask: watchedStatus,
  later(ms, act) {
    const timer = setTimeout(act, ms);
    return () => clearTimeout(timer);
  },
  random: Math.random,
};

export class StatusFeed {
  #url;
  #onStatus;
  #onState;
  #topics;
  #world;
  #state = "connecting";
  #socket = null;
  #heard = 0; // states of this connection
  #attempts = 0;
  #cancelSilence = () => {};
  #poll = null; // the polling under way
  #failures = 0;

  /**
   * @param {object} wiring
   * @param {string} wiring.url of rosbridge
   * @param {(status: WatchedStatus) => void} wiring.onStatus
   * @param {(state: FeedState) => void} wiring.onState on each change
   * @param {import("../drive/connection.js").Topic[]} [wiring.topics] what rosbridge is to bring besides
   * @param {object} world sockets, HTTP and time; tests have their own
   */
  constructor({ url, onStatus, onState, topics = [] }, world = browser) {
    this.#url = url;
    this.#onStatus = onStatus;
    this.#onState = onState;
    this.#topics = topics;
    this.#world = world;
  }

  start() {
    this.#connect();
  }

  #connect() {
    const socket = this.#world.open(this.#url);
    this.#socket = socket;
    this.#heard = 0;
    socket.onopen = () => [SUBSCRIPTION, ...this.#topics.map(subscription)].forEach((wanted) => socket.send(JSON.stringify(wanted)));
    socket.onmessage = ({ data }) => this.#hear(JSON.parse(data));
    socket.onclose = () => this.#drop();
    this.#awaitNews();
  }

  #hear({ op, level, id, topic, msg }) {
    if (op === "status" && level === "error" && id === SUBSCRIPTION.id) this.#drop(); // it refuses the subscription
    if (op !== "publish") return;
    if (topic !== SUBSCRIPTION.topic) {
      this.#topics.find((wanted) => wanted.topic === topic)?.take(msg);
      return;
    }
    this.#awaitNews();
    this.#heard += 1;
    // rosbridge may still know the last state of a server that is gone: only the next one shows that there is one
    if (this.#heard > 1 || this.#state === "connecting") {
      this.#attempts = 0;
      this.#poll = null;
      this.#become("live");
    }
    this.#onStatus(read(msg));
  }

  #awaitNews() {
    this.#cancelSilence();
    this.#cancelSilence = this.#world.later(SILENCE, () => this.#drop());
  }

  /** This connection is of no use: ask by HTTP until another one is. */
  #drop() {
    const socket = this.#socket;
    if (!socket) return;
    this.#socket = null;
    socket.onopen = socket.onmessage = socket.onclose = null;
    socket.close();
    this.#cancelSilence();
    const wait = Math.min(MOST_RETRY, RETRY * 2 ** this.#attempts);
    this.#attempts += 1;
    this.#world.later(this.#spread(wait), () => this.#connect());
    if (!this.#poll) this.#startPolling();
  }

  #startPolling() {
    const poll = (this.#poll = {});
    this.#failures = 0;
    const ask = async () => {
      const message = await this.#world.ask().catch(() => null);
      if (poll !== this.#poll) return; // the socket is back
      this.#failures = message ? 0 : this.#failures + 1;
      if (message) {
        this.#become("live");
        this.#onStatus(read(message));
      } else if (this.#failures >= LOST_AFTER) {
        this.#become("lost");
      }
      this.#world.later(this.#spread(POLL), () => poll === this.#poll && ask());
    };
    ask();
  }

  /** Many pages have lost the same server at the same moment: they do not come back at the same one. */
  #spread(ms) {
    return ms * (0.5 + this.#world.random());
  }

  #become(state) {
    if (state === this.#state) return;
    this.#state = state;
    this.#onState(state);
  }
}
