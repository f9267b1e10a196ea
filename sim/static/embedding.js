// Inside a page of the game: it tells who plays, and hears whether the picture lives.

import { isGame, readPlayers } from "./players.js";

const REPORT = 1500; // ms between two reports; the page waits 6 s

export class Embedding {
  #receive;
  #report;

  /**
   * @param {(players: import("./players.js").Players) => void} receive gets each news of the page around
   * @param {() => {state: string, fps: number, effects: number}} report what the page around is to know
   */
  constructor(receive, report) {
    this.#receive = receive;
    this.#report = report;
  }

  start() {
    window.addEventListener("message", (event) => this.#hear(event));
    setInterval(() => this.tell(), REPORT);
    this.tell();
  }

  /** Report now. */
  tell() {
    // to whoever it is: nothing is secret, and the Content-Security-Policy lets only the game's pages be around us
    window.parent.postMessage({ type: "laserbot-arena", ...this.#report() }, "*");
  }

  #hear({ source, origin, data }) {
    if (source !== window.parent || !isGame(origin, location.hostname)) return;
    const players = readPlayers(data, origin);
    if (players) this.#receive(players);
  }
}
