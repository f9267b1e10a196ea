// The switch that lays the picture of the camera above the floor under the robots that the page draws. It is off until
// somebody wants it, and hidden where there is no such camera.

import { socketAddress } from "../common/addresses.js";
import { FloorPicture } from "./floor_picture.js";

const byId = (id) => document.getElementById(id);

export class RealFloor {
  #preferences;
  #picture;
  #watcher = new IntersectionObserver((entries) => this.#see(entries.at(-1).isIntersecting));
  #isSeen = false; // the arena on this page

  /**
   * @param {object} wiring
   * @param {HTMLElement} wiring.box of the arena: nothing is fetched while nobody sees it
   * @param {import("../common/preferences_store.js").Preferences} wiring.preferences
   * @param {"tags"|"floor"} [wiring.level] what lies at its place: robots by their tags, or the floor itself
   * @param {() => Promise<{user?: string, ticket: string}|null>} [wiring.getTicket] says whose page this is
   * @param {(picture: OffscreenCanvas|null) => void} wiring.onPicture draws it; null: the drawn floor again
   */
  constructor({ box, preferences, level, getTicket, onPicture }) {
    this.#preferences = preferences;
    this.#picture = new FloorPicture({ url: socketAddress("relay"), level, getTicket, onPicture, onState: () => this.#show() });
    byId("real-floor").addEventListener("click", () => preferences.toggle("realFloor"));
    preferences.watch(() => this.#show());
    this.#watcher.observe(box);
  }

  /** What the page's connection to rosbridge is to bring. */
  get topics() {
    return this.#picture.topics;
  }

  /** What the arena's picture shows. @param {import("./rectify.js").Frame} frame */
  show(frame) {
    this.#picture.frame = frame;
  }

  stop() {
    this.#watcher.disconnect();
    this.#see(false);
  }

  #see(isSeen) {
    this.#isSeen = isSeen;
    this.#show();
  }

  #show() {
    const { state } = this.#picture;
    const isOn = this.#preferences.get("realFloor");
    byId("real-floor").hidden = state === "none";
    byId("real-floor").setAttribute("aria-pressed", String(isOn));
    byId("real-floor-note").hidden = state !== "away";
    this.#picture.look(state !== "none" && isOn && this.#isSeen);
  }
}
