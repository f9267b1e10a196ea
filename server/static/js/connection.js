// The rosbridge rim: one WebSocket that comes back by itself. Nothing is ever queued: what cannot be sent now is dropped.

import { Ros, Topic, WebSocketTransportFactory } from "roslib";
import { isNeutral } from "./keys.js";

const RETRY = 1000; // ms from a lost connection to the next attempt
const SILENCE = 4000; // ms; the state is published every 500 ms, so such a connection is half-open
const BACKLOG = 1024; // bytes not yet on the wire: about five commands, 125 ms

/** Subscribes to /game_status and publishes commands. */
export class Connection {
  #url;
  #onStatus;
  #onChange;
  #ros = null;
  #up = false;
  #socket = null;
  #commands = null; // { robot, topic } of this connection
  #timer = null;
  #stopped = true;

  /**
   * @param {object} wiring
   * @param {string} wiring.url of rosbridge, ws://host:port
   * @param {(message: object) => void} wiring.onStatus gets each laser_bot_battle/GameStatus
   * @param {(up: boolean) => void} wiring.onChange
   */
  constructor({ url, onStatus, onChange }) {
    this.#url = url;
    this.#onStatus = onStatus;
    this.#onChange = onChange;
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
   * Send a Robot_msg to a robot now, or drop it: while it is down, and, unless it says stop, while the network is
   * slower than the player.
   * @returns {boolean} whether it was sent
   */
  publish(robot, command) {
    if (!this.#up) return false;
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

  #topic(name, messageType) {
    return new Topic({ ros: this.#ros, name, messageType, reconnect_on_close: false });
  }

  #connect() {
    // a new Ros for each attempt: roslib would play what an old one has queued
    const ros = new Ros({
      transportFactory: async (url) => {
        const transport = await WebSocketTransportFactory(url);
        this.#socket = transport.socket; // its bufferedAmount tells a slow network
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
    this.#ros?.removeAllListeners();
    this.#ros?.close();
    this.#ros = null;
    this.#socket = null;
    this.#commands = null;
    this.#setUp(false);
  }

  #setUp(up) {
    if (up === this.#up) return;
    this.#up = up;
    this.#onChange(up);
  }
}
