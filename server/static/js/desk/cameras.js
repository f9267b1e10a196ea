// The cameras on the operator's desk: one robot's picture in the panel #camera-panel, and the relay's figures in #cameras.

import * as api from "./api.js";
import { socketAddress } from "../common/addresses.js";
import { ABOVE } from "../camera/picture.js";
import { Camera } from "../camera/relay.js";
import { CameraView } from "../camera/view.js";
import { setText } from "../common/dom.js";
import { rowButton, setCell, showRows, tableRow } from "./rows.js";
import { cameraRow } from "./words.js";
import { number, t } from "../common/words.js";

const ASK = 2000; // ms between two questions for the figures
const SILENCE = 3; // questions in a row without an answer

const COLUMNS = [
  ["id", t("desk.robot")], ["state", t("desk.camera_state")], ["viewers", t("desk.camera_viewers")], ["rate", t("desk.camera_rate")],
  ["age", t("desk.camera_age")], ["size", t("desk.camera_size")],
];

const byId = (id) => document.getElementById(id);

export class Cameras {
  #picture = new CameraView({ canvas: byId("camera"), note: byId("camera-note"), age: byId("camera-age") });
  #camera;
  #opener = null; // has the focus again afterwards
  #unanswered = 0;

  constructor() {
    this.#camera = new Camera({
      url: socketAddress("relay"),
      getTicket: api.camera,
      onState: (state) => this.#picture.show(state),
      onPicture: (bitmap, takenAt) => this.#picture.draw(bitmap, takenAt),
      onFigures: (figures) => this.#show(figures),
    });
    byId("camera-panel").addEventListener("keydown", (event) => event.key === "Escape" && this.close());
    byId("camera-close").addEventListener("click", () => this.close());
  }

  start() {
    this.#camera.start();
    setInterval(() => document.hidden || this.#ask(), ASK);
  }

  /** Look through the camera of this robot, or the one ABOVE. */
  look(robot) {
    this.#opener = document.activeElement;
    setText(byId("camera-title"), robot === ABOVE ? t("desk.camera_above") : t("desk.camera_of", { id: robot }));
    this.#picture.clear();
    this.#camera.watch(robot);
    byId("camera-panel").hidden = false;
    byId("camera-panel").scrollIntoView({ block: "nearest" });
    byId("camera-close").focus();
  }

  close() {
    this.#camera.watch(null);
    const hadFocus = byId("camera-panel").contains(document.activeElement);
    byId("camera-panel").hidden = true;
    if (hadFocus) (this.#opener.isConnected ? this.#opener : byId("robots-title")).focus();
  }

  #ask() {
    this.#unanswered += 1;
    this.#camera.askFigures();
    if (this.#unanswered > SILENCE) byId("cameras-silent").hidden = false;
  }

  #show({ viewers, most_viewers, mbit, most_mbit, cameras }) {
    this.#unanswered = 0;
    byId("cameras-silent").hidden = true;
    const of = (value, most) => t("desk.of_most", { value: number(value), most: number(most) });
    setText(byId("cameras-viewers"), of(viewers, most_viewers));
    setText(byId("cameras-rate"), of(mbit, most_mbit));
    showRows(byId("cameras-rows"), cameras, {
      key: ({ robot }) => String(robot),
      make: ({ robot }) => {
        const about = robot === ABOVE ? t("desk.camera_above") : t("desk.of_robot", { id: robot });
        return tableRow(COLUMNS, [rowButton(t("desk.camera"), about, () => this.look(robot))]);
      },
      fill: (row, camera) => {
        for (const [field, value] of Object.entries(cameraRow(camera))) setCell(row, field, value);
      },
    });
  }
}
