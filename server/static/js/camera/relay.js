// The rim of the cameras' relay: one WebSocket that comes back by itself, and the newest picture of the camera that is
// wished for. docs/protocol-camera.md

import { ClockOffset } from "./clock.js";
import { pictureOf } from "./picture.js";

const RETRY = 500; // ms to the second attempt; each later one takes twice as long
const MOST_RETRY = 8000; // ms
const OPENING = 4000; // ms; a network that does not even refuse
const SILENCE = 5000; // ms; the relay tells within 3 s that a camera sends nothing, so such a connection is half-open

/** @typedef {{robot: number, state: "live"|"waiting"|"none"|"refused", reason: string}} CameraState */

const browser = {
  open: (url) => new WebSocket(url),
  decode: (jpeg) => createImageBitmap(new Blob([jpeg], { type: "image/jpeg" })),
  now: () => performance.now() / 1000,
  later(ms, act) {
    const timer = setTimeout(act, ms);
    return () => clearTimeout(timer);
  },
  random: Math.random,
  isHidden: () => document.hidden,
  onHiding: (act) => document.addEventListener("visibilitychange", act),
};

/** Looks through one robot's camera at a time, and through none while nobody sees the page. */
export class Camera {
  #url;
  #onState;
  #onPicture;
  #onFigures;
  #getTicket;
  #world;
  #socket = null;
  #wish = null; // the robot to look through
  #said = null; // what the relay knows of that
  #live = false; // pictures are to come
  #allowed = false; // those that are here may be shown
  #clock = new ClockOffset();
  #next = null; // the newest picture that waits for the one being decoded
  #decoding = false;
  #shown = null; // the picture that was drawn last of what is wished for
  #attempts = 0;
  #pace; // ms between two pictures at least
  #nextAt = -Infinity; // when the relay may be told that the next one was seen, s
  #cancel = () => {}; // of the timer for this connection's end, or the next one's beginning

  /**
   * @param {object} wiring
   * @param {string} wiring.url of the relay
   * @param {(state: CameraState) => void} [wiring.onState] what became of the wish
   * @param {(bitmap: ImageBitmap|null, takenAt: number) => boolean|void} [wiring.onPicture] draws at once; null: it looks like
   *   the one before. `takenAt` is when it was taken, in s of performance.now() / 1000. Returns false if the picture was not
   *   shown: then the next one is decoded even if it looks the same
   * @param {(figures: object) => void} [wiring.onFigures] what operators get for `askFigures`
   * @param {() => Promise<{user?: string, ticket: string}|null>} [wiring.getTicket] says whose page this is: the cookie
   *   does not always come along with a WebSocket
   * @param {number} [wiring.pace] ms between two pictures; the newest is as new as without it
   * @param {object} world sockets, pictures, time and the page's visibility; tests have their own
   */
  constructor({ url, onState = () => {}, onPicture = () => {}, onFigures = () => {}, getTicket, pace = 0 }, world = browser) {
    this.#url = url;
    this.#onState = onState;
    this.#onPicture = onPicture;
    this.#onFigures = onFigures;
    this.#getTicket = getTicket;
    this.#pace = pace;
    this.#world = world;
    world.onHiding(() => this.#sayWish());
  }

  start() {
    this.#connect();
  }

  stop() {
    this.#drop();
  }

  /** Look through the camera of this robot from now on, through the one ABOVE, or through none. @param {number|null} robot */
  watch(robot) {
    if (robot === this.#wish) return;
    this.#wish = robot;
    this.#sayWish();
  }

  /** Ask for the operators' figures. */
  askFigures() {
    this.#say({ op: "figures" });
  }

  #connect() {
    const socket = this.#world.open(this.#url);
    socket.binaryType = "arraybuffer";
    this.#socket = socket;
    this.#said = null;
    this.#clock = new ClockOffset();
    socket.onopen = () => this.#begin(socket);
    socket.onmessage = ({ data }) => this.#hear(data);
    socket.onclose = () => this.#again();
    this.#endIn(OPENING);
  }

  async #begin(socket) {
    this.#cancel();
    this.#sayWish();
    const session = await this.#getTicket?.().catch(() => null);
    if (session && socket === this.#socket) this.#say({ op: "auth", mac: session.ticket, client: session.user });
  }

  #sayWish() {
    const wish = this.#world.isHidden() ? null : this.#wish;
    if (this.#socket?.readyState !== WebSocket.OPEN || wish === this.#said) return;
    this.#said = wish;
    this.#live = this.#allowed = false;
    this.#shown = null;
    this.#say({ op: "watch", robot: wish });
    if (wish === null) this.#cancel();
    else this.#endIn(SILENCE); // unless it says what became of the wish
  }

  #say(operation) {
    if (this.#socket?.readyState === WebSocket.OPEN) this.#socket.send(JSON.stringify(operation));
  }

  #hear(data) {
    this.#attempts = 0;
    if (typeof data !== "string") {
      this.#take(pictureOf(data));
      return;
    }
    const message = JSON.parse(data);
    if (message.op === "figures") this.#onFigures(message);
    if (message.op !== "camera" || message.robot !== this.#said) return;
    this.#live = message.state === "live";
    this.#allowed = this.#live || message.state === "waiting"; // a camera that is away may send a picture that says so
    this.#awaitPicture();
    this.#onState({ robot: message.robot, state: message.state, reason: message.reason });
  }

  /** Pictures come, or else the wish is said again now and then: nobody tells a page that its connection is half-open. */
  #awaitPicture() {
    if (this.#live) {
      this.#endIn(SILENCE);
      return;
    }
    this.#cancel();
    this.#cancel = this.#world.later(SILENCE, () => {
      this.#said = null;
      this.#sayWish();
    });
  }

  /** A picture has come: at most one is decoded at a time, and of those that wait meanwhile only the newest counts. */
  async #take(picture) {
    if (!picture) return;
    this.#awaitPicture();
    const takenAt = picture.taken + this.#clock.sample(picture.sent, this.#world.now());
    if (this.#next) this.#seen(this.#socket); // it gives way
    this.#next = { ...picture, takenAt, socket: this.#socket };
    if (this.#decoding) return;
    this.#decoding = true;
    while (this.#next) {
      const newest = this.#next;
      this.#next = null;
      await this.#draw(newest);
    }
    this.#decoding = false;
  }

  async #draw({ jpeg, robot, takenAt, socket }) {
    const isSame = this.#shown !== null && isEqual(jpeg, this.#shown);
    const bitmap = isSame ? null : await this.#world.decode(jpeg).catch(() => null); // a broken picture is skipped
    if (socket !== this.#socket) return;
    if ((bitmap || isSame) && this.#allowed && robot === this.#said) {
      const isShown = this.#onPicture(bitmap, takenAt) !== false;
      this.#shown = isShown ? jpeg : null;
    }
    bitmap?.close();
    this.#seen(socket);
  }

  /** The relay may send another one. */
  #seen(socket) {
    const now = this.#world.now();
    const wait = Math.max(0, this.#nextAt - now);
    this.#nextAt = now + wait + this.#pace / 1000;
    const say = () => socket === this.#socket && this.#say({ op: "seen" });
    if (wait > 0) this.#world.later(wait * 1000, say);
    else say();
  }

  #endIn(ms) {
    this.#cancel();
    this.#cancel = this.#world.later(ms, () => this.#again());
  }

  /** This connection is of no use: another one, soon. Many pages lose the same relay at the same moment, and come back spread. */
  #again() {
    this.#drop();
    const wait = Math.min(MOST_RETRY, RETRY * 2 ** this.#attempts) * (0.5 + this.#world.random());
    this.#attempts += 1;
    this.#cancel = this.#world.later(wait, () => this.#connect());
  }

  #drop() {
    this.#cancel();
    const socket = this.#socket;
    if (!socket) return;
    this.#socket = null;
    this.#live = false;
    socket.onopen = socket.onmessage = socket.onclose = null;
    socket.close();
  }
}

/** Whether they are the same bytes: a virtual camera that sees nothing move sends its picture again. */
const isEqual = (one, other) => one.length === other.length && one.every((byte, place) => byte === other[place]);
