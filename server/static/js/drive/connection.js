// The rosbridge rim: one WebSocket that comes back by itself. Nothing is ever queued: what cannot be sent now is dropped.

import { isNeutral } from "./keys.js";

const STATE = "/game_status";
const RETRY = 250; // ms from a lost connection to the next attempt; each later one takes twice as long
const MOST_RETRY = 1000; // ms
const SILENCE = 4000; // ms; the state is published every 500 ms, so such a connection is half-open
const BACKLOG = 1024; // bytes not yet on the wire: about five commands, 125 ms
const PROBE = 2000; // ms between two measurements of the way to rosbridge and back
const PROBE_ID = "round-trip"; // of the service call that measures it
const SIGN_IN = 1000; // ms that commands wait for the ticket; with a cookie they may pass without it

/**
 * What a connection brings besides.
 * @typedef {{topic: string, type: string, throttle_rate?: number, queue_length?: number, take: (message: object) => void}} Topic
 */

/** The operation by which rosbridge sends it; JSON leaves `take` out. @param {Topic} wanted */
export const subscription = (wanted) => ({ op: "subscribe", id: `subscribe:${wanted.topic}`, ...wanted });

/** Subscribes to /game_status, signs in and publishes commands. */
export class Connection {
  #url;
  #onStatus;
  #onChange;
  #onRefusal;
  #onRoundTrip;
  #getTicket;
  #topics;
  #socket = null;
  #up = false;
  #mayPublish = false; // not before it is said whose commands they are
  #advertised = null; // the topic of this connection's commands
  #timer = null;
  #attempts = 0; // since something was heard
  #prober = null;
  #probedAt = null; // ms, while an answer is awaited
  #stopped = true;

  /**
   * @param {object} wiring
   * @param {string} wiring.url of rosbridge, ws://host:port
   * @param {(message: object) => void} wiring.onStatus gets each laser_bot_battle/GameStatus
   * @param {(up: boolean) => void} wiring.onChange
   * @param {(reason: string) => void} wiring.onRefusal rosbridge refuses a command
   * @param {(ms: number) => void} [wiring.onRoundTrip] how long rosbridge takes to answer, or how long it has not
   * @param {() => Promise<{user: string, ticket: string}|null>} wiring.getTicket for the player of this page
   * @param {Topic[]} [wiring.topics]
   */
  constructor({ url, onStatus, onChange, onRefusal, onRoundTrip, getTicket, topics = [] }) {
    this.#url = url;
    this.#onStatus = onStatus;
    this.#onChange = onChange;
    this.#onRefusal = onRefusal;
    this.#onRoundTrip = onRoundTrip;
    this.#getTicket = getTicket;
    this.#topics = topics;
  }

  get up() {
    return this.#up;
  }

  start() {
    this.#stopped = false;
    this.#connect();
  }

  stop() {
    this.#stopped = true;
    this.#drop();
  }

  /**
   * Send a Robot_msg to a robot now, or drop it: while it is down or not signed in, and, unless it says stop, while the
   * network is slower than the player.
   * @returns {boolean} whether it was sent
   */
  publish(robot, command) {
    if (!this.#mayPublish) return false;
    if (this.#socket.bufferedAmount > BACKLOG && !isNeutral(command)) return false;
    const topic = `/Robot${robot}/command`;
    if (this.#advertised !== topic) {
      this.#advertised = topic;
      this.#say({ op: "advertise", id: `advertise:${topic}`, topic, type: "laser_bot_battle/Robot_msg" });
    }
    this.#say({ op: "publish", id: `publish:${topic}`, topic, msg: command });
    return true;
  }

  /** The right to publish has ended; the next battle advertises again. */
  unadvertise() {
    if (this.#advertised) this.#say({ op: "unadvertise", topic: this.#advertised });
    this.#advertised = null;
  }

  /** Say whose page this is: the cookie does not always come along with a WebSocket. */
  async signIn() {
    const socket = this.#socket;
    const session = await this.#getTicket().catch(() => null);
    if (!session || !this.#up || socket !== this.#socket) return;
    const unused = { dest: "", rand: "", t: 0, level: "", end: 0 };
    this.#say({ op: "auth", mac: session.ticket, client: session.user, ...unused });
  }

  #say(operation) {
    // one that is closing has not told so yet
    if (this.#socket.readyState === WebSocket.OPEN) this.#socket.send(JSON.stringify(operation));
  }

  #connect() {
    const socket = new WebSocket(this.#url);
    this.#socket = socket;
    socket.addEventListener("open", () => socket === this.#socket && this.#begin());
    socket.addEventListener("message", ({ data }) => socket === this.#socket && this.#hear(JSON.parse(data)));
    socket.addEventListener("close", () => {
      if (socket !== this.#socket) return;
      this.#drop();
      this.#retryIn(Math.min(MOST_RETRY, RETRY * 2 ** this.#attempts));
      this.#attempts += 1;
    });
    this.#retryIn(SILENCE); // for a network that does not even refuse
  }

  async #begin() {
    const socket = this.#socket;
    this.#say(subscription({ topic: STATE, type: "laser_bot_battle/GameStatus" }));
    for (const wanted of this.#topics) this.#say(subscription(wanted));
    this.#retryIn(SILENCE);
    this.#setUp(true);
    await Promise.race([this.signIn(), new Promise((resolve) => setTimeout(resolve, SIGN_IN))]);
    if (socket !== this.#socket) return;
    this.#mayPublish = true;
    if (!this.#onRoundTrip) return;
    this.#probe();
    this.#prober = setInterval(() => this.#probe(), PROBE);
  }

  /** Ask rosbridge the time: what comes back goes the way of the commands. */
  #probe() {
    const now = performance.now();
    if (this.#probedAt !== null) {
      this.#onRoundTrip(now - this.#probedAt);
      return;
    }
    this.#probedAt = now;
    this.#say({ op: "call_service", id: PROBE_ID, service: "/rosapi/get_time", args: {} });
  }

  #hear({ op, topic, level, id, msg }) {
    if (op === "publish" && topic === STATE) {
      this.#retryIn(SILENCE);
      this.#attempts = 0;
      this.#onStatus(msg);
    } else if (op === "publish") {
      this.#topics.find((wanted) => wanted.topic === topic)?.take(msg);
    } else if (op === "service_response" && id === PROBE_ID && this.#probedAt !== null) {
      this.#onRoundTrip(performance.now() - this.#probedAt);
      this.#probedAt = null;
    } else if (op === "status" && level === "error" && /^(publish|advertise):/.test(id)) {
      this.#onRefusal(msg);
    }
  }

  /** Connect again unless something arrives within `ms`. */
  #retryIn(ms) {
    clearTimeout(this.#timer);
    if (this.#stopped) return;
    this.#timer = setTimeout(() => {
      this.#drop();
      this.#connect();
    }, ms);
  }

  /** Forget this connection: a half-open one would take long to close. */
  #drop() {
    clearTimeout(this.#timer);
    clearInterval(this.#prober);
    this.#probedAt = null;
    this.#socket?.close();
    this.#socket = null;
    this.#advertised = null;
    this.#mayPublish = false;
    this.#setUp(false);
  }

  #setUp(up) {
    if (up === this.#up) return;
    this.#up = up;
    this.#onChange(up);
  }
}
