// The rosbridge rim: one WebSocket that comes back by itself. Nothing is ever queued: what cannot be sent now is dropped.

import { Ros, Topic, WebSocketTransportFactory } from "roslib";
import { isNeutral } from "./keys.js";

const RETRY = 1000; // ms from a lost connection to the next attempt
const SILENCE = 4000; // ms; the state is published every 500 ms, so such a connection is half-open
const BACKLOG = 1024; // bytes not yet on the wire: about five commands, 125 ms
const PROBE = 2000; // ms between two measurements of the way to rosbridge and back
const PROBE_ID = "round-trip"; // of the service call that measures it; no call of roslib's has such an id
const SIGN_IN = 1000; // ms that commands wait for the ticket; with a cookie they may pass without it

/** Subscribes to /game_status, signs in and publishes commands. */
export class Connection {
  #url;
  #onStatus;
  #onChange;
  #onRefusal;
  #onRoundTrip;
  #getTicket;
  #ros = null;
  #up = false;
  #mayPublish = false; // not before it is said whose commands they are
  #socket = null;
  #commands = null; // { robot, topic } of this connection
  #timer = null;
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
   */
  constructor({ url, onStatus, onChange, onRefusal, onRoundTrip, getTicket }) {
    this.#url = url;
    this.#onStatus = onStatus;
    this.#onChange = onChange;
    this.#onRefusal = onRefusal;
    this.#onRoundTrip = onRoundTrip;
    this.#getTicket = getTicket;
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
    if (this.#commands?.robot !== robot) {
      this.#commands = { robot, topic: this.#topic(`/Robot${robot}/command`, "laser_bot_battle/Robot_msg") };
    }
    this.#commands.topic.publish(command);
    return true;
  }

  /** The right to publish has ended; the next battle advertises again. */
  unadvertise() {
    if (this.#up) this.#commands?.topic.unadvertise();
    this.#commands = null;
  }

  /** Say whose page this is: the cookie does not always come along with a WebSocket. */
  async signIn() {
    const ros = this.#ros;
    const session = await this.#getTicket().catch(() => null);
    if (session && this.#up && ros === this.#ros) ros.authenticate(session.ticket, session.user, "", "", 0, "", 0);
  }

  #topic(name, messageType) {
    return new Topic({ ros: this.#ros, name, messageType, reconnect_on_close: false });
  }

  #connect() {
    // a new Ros for each attempt: roslib would play what an old one has queued
    const ros = new Ros({
      transportFactory: async (url) => {
        const transport = await WebSocketTransportFactory(url);
        this.#socket = transport.socket; // its bufferedAmount tells a slow network
        transport.on("message", (message) => ros === this.#ros && this.#hear(message));
        return transport;
      },
    });
    this.#ros = ros;
    ros.on("connection", () => {
      this.#topic("/game_status", "laser_bot_battle/GameStatus").subscribe((message) => {
        this.#retryIn(SILENCE);
        this.#onStatus(message);
      });
      this.#retryIn(SILENCE);
      this.#setUp(true);
      const timeout = new Promise((resolve) => setTimeout(resolve, SIGN_IN));
      Promise.race([this.signIn(), timeout]).then(() => {
        if (ros !== this.#ros) return;
        this.#mayPublish = true;
        if (!this.#onRoundTrip) return;
        this.#probe();
        this.#prober = setInterval(() => this.#probe(), PROBE);
      });
    });
    ros.on("close", () => {
      this.#drop();
      this.#retryIn(RETRY);
    });
    this.#retryIn(SILENCE); // for a network that does not even refuse
    ros.connect(this.#url).then(
      () => ros !== this.#ros && ros.close(), // dropped meanwhile
      (error) => console.error(`rosbridge at ${this.#url}:`, error),
    );
  }

  /** Ask rosbridge the time: what comes back goes the way of the commands. */
  #probe() {
    const now = performance.now();
    if (this.#probedAt !== null) {
      this.#onRoundTrip(now - this.#probedAt);
      return;
    }
    this.#probedAt = now;
    this.#ros.callOnConnection({ op: "call_service", id: PROBE_ID, service: "/rosapi/get_time", args: {} });
  }

  /** Statuses, which roslib tells only to who knows their ids: those of commands begin as roslib makes them. */
  #hear({ op, level, id, msg }) {
    if (op === "service_response" && id === PROBE_ID && this.#probedAt !== null) {
      this.#onRoundTrip(performance.now() - this.#probedAt);
      this.#probedAt = null;
    }
    const isOfCommand = typeof id === "string" && /^(publish|advertise):\/Robot/.test(id);
    if (op === "status" && level === "error" && isOfCommand) this.#onRefusal(msg);
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
    this.#ros?.removeAllListeners();
    this.#ros?.close();
    this.#ros = null;
    this.#socket = null;
    this.#commands = null;
    this.#mayPublish = false;
    this.#setUp(false);
  }

  #setUp(up) {
    if (up === this.#up) return;
    this.#up = up;
    this.#onChange(up);
  }
}
