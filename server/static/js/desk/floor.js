// The desk's editor of the floor: a drawing and a list of the same things. The server says what is wrong, and keeps it.

import { element, setText } from "../common/dom.js";
import { socketAddress } from "../common/addresses.js";
import * as dialogs from "../common/dialogs.js";
import { Preferences } from "../common/preferences_store.js";
import { t } from "../common/words.js";
import * as api from "./api.js";
import { FloorDrawing, MARGIN } from "./floor_drawing.js";
import { FloorList } from "./floor_list.js";
import * as plans from "./floor_plan.js";
import { RealFloor } from "../overhead/real_floor.js";
import { StatusFeed } from "../battle/status_feed.js";

const CHECK = 250; // ms without a change until the server is asked

const byId = (id) => document.getElementById(id);

export class FloorEditor {
  #act;
  #fail;
  #history = null;
  #known = null; // the answer of GET floor
  #selected = null;
  #problems = [];
  #tags = [];
  #isChecked = false; // the newest plan has been
  #battles = false; // a countdown or battle runs
  #timer = 0;
  #drawing;
  #list;
  #realFloor;
  #size = ""; // that the picture of the real floor has

  /**
   * @param {(order: () => Promise<void>) => Promise<void>} act does what somebody has asked for
   * @param {(error: Error) => void} fail says what could not be done
   */
  constructor(act, fail) {
    this.#act = act;
    this.#fail = fail;
    const on = {
      select: (thing) => this.#select(thing),
      change: (plan, key) => this.#change(plan, key),
      remove: (thing) => this.#remove(thing),
    };
    this.#drawing = new FloorDrawing(byId("floor-picture"), on);
    this.#list = new FloorList(byId("floor-things"), on);
    this.#realFloor = new RealFloor({
      box: byId("floor-picture"),
      level: "floor",
      preferences: new Preferences(),
      getTicket: api.camera,
      onPicture: (picture) => (this.#drawing.realFloor = picture),
    });
  }

  start() {
    byId("floor-details").addEventListener("toggle", ({ target }) => target.open && !this.#known && this.#open());
    byId("floor-add").addEventListener("click", ({ target }) => this.#add(target.closest("button")?.dataset.add));
    byId("floor-undo").addEventListener("click", () => this.#undo());
    byId("floor-load").addEventListener("click", () => this.#loadAgain());
    byId("floor-download").addEventListener("click", () => this.#history && this.#download());
    byId("floor-save").addEventListener("click", () => this.#why() === "" && this.#act(() => this.#save()));
    for (const side of ["width", "height"]) {
      byId(`floor-${side}`).addEventListener("input", ({ target }) => {
        const value = target.valueAsNumber;
        if (this.#history) this.#change({ ...this.#history.plan, [side]: Number.isNaN(value) ? null : value }, `field ${side}`);
      });
    }
    byId("floor-details").addEventListener("keydown", (event) => {
      const isUndo = event.key === "z" && (event.ctrlKey || event.metaKey) && !event.target.matches("input");
      if (isUndo) event.preventDefault();
      if (isUndo) this.#undo();
    });
    addEventListener("beforeunload", (event) => this.#history?.isChanged && event.preventDefault());
  }

  /** @param {{state: string}} game of the desk's state */
  show({ state }) {
    this.#battles = state !== "stopped";
    this.#showState();
  }

  async #open() {
    await this.#act(() => this.#load());
    if (!this.#known) return;
    const nothing = () => {}; // the desk has the battle's state from elsewhere
    new StatusFeed({ url: socketAddress("rosbridge"), onStatus: nothing, onState: nothing, topics: this.#realFloor.topics }).start();
  }

  async #load() {
    this.#known = await api.floor();
    this.#history = new plans.History(plans.readPlan(this.#known.floor));
    this.#selected = null;
    const { name, path, is_writable: isWritable } = this.#known;
    setText(byId("floor-source"), t(isWritable ? "floor.is_file" : name ? "floor.is_own" : "floor.is_read_only", { name, path }));
    byId("floor-save").hidden = !isWritable;
    byId("floor-download").classList.toggle("quiet", isWritable); // else it is what one comes for
    byId("floor-editor").hidden = false;
    this.#changed();
  }

  async #loadAgain() {
    const question = { kind: "warning", title: t("floor.load_sure"), text: t("floor.load_text"), ok: t("floor.load"), cancel: t("common.cancel"), calm: true };
    if (!this.#history.isChanged || (await dialogs.show(question))) await this.#act(() => this.#load());
  }

  #change(plan, key) {
    this.#history.change(plan, key);
    this.#changed();
  }

  #changed() {
    this.#isChecked = false;
    clearTimeout(this.#timer);
    this.#timer = setTimeout(() => this.#check(), CHECK);
    this.#show();
  }

  async #check() {
    const { plan } = this.#history;
    try {
      const { problems, tags } = await api.checkFloor(plan);
      if (plan !== this.#history.plan) return; // it has been changed again
      this.#problems = problems;
      if (tags.length) this.#tags = tags;
      this.#isChecked = true;
      this.#show();
    } catch (error) {
      this.#fail(error);
    }
  }

  async #save() {
    const { plan } = this.#history;
    this.#known.version = (await api.saveFloor(plan, this.#known.version)).version;
    this.#history.save(plan);
    this.#show();
    dialogs.toast(t("floor.saved"));
  }

  #download() {
    const { plan } = this.#history;
    const { name, path, is_writable: isWritable } = this.#known;
    download(plan, name ? "laserbot-floor.json" : path.split("/").at(-1));
    if (isWritable) return;
    this.#history.save(plan); // as far as that goes here: nothing is lost when the page is left
    this.#show();
  }

  #add(kind) {
    if (!kind || !this.#history) return;
    const [plan, thing] = plans.added(this.#history.plan, kind);
    this.#selected = thing;
    this.#change(plan, `add ${plans.keyOf(thing)}`);
    this.#drawing.focus(thing);
    this.#list.reveal(thing);
  }

  #remove(thing) {
    this.#selected = null;
    this.#change(plans.removed(this.#history.plan, thing), null);
    byId("floor-undo").focus(); // what had the focus has gone
  }

  #undo() {
    if (!this.#history?.canUndo) return;
    this.#selected = null;
    this.#history.undo();
    this.#changed();
  }

  #select(thing) {
    if (plans.isSame(thing, this.#selected)) return;
    this.#selected = thing;
    this.#show();
    if (thing) this.#list.reveal(thing);
  }

  #show() {
    const { plan } = this.#history;
    for (const side of ["width", "height"]) {
      const input = byId(`floor-${side}`);
      if (input.valueAsNumber !== plan[side] && plan[side] !== null) input.value = plan[side];
    }
    this.#showRealFloor(plan);
    this.#drawing.show(plan, this.#selected, new Set(this.#problems.map(({ about }) => about)), this.#tags);
    this.#list.show(plan, this.#selected, this.#problems);
    byId("floor-undo").setAttribute("aria-disabled", !this.#history.canUndo);
    const keys = new Set(plans.thingsOf(plan).map(plans.keyOf));
    const others = this.#problems.filter(({ about }) => !keys.has(about));
    byId("floor-problems").hidden = others.length === 0;
    byId("floor-problems").replaceChildren(...others.map(({ about, error }) => element("li", {}, about ? `${about}: ${error}` : error)));
    this.#showState();
  }

  #showRealFloor(plan) {
    const { width, height } = plan;
    const size = `${width} x ${height}`;
    if (size === this.#size || !plans.hasSize(plan)) return;
    this.#size = size;
    this.#realFloor.show({ left: -MARGIN, bottom: -MARGIN, right: width + MARGIN, top: height + MARGIN });
  }

  /** Why it cannot be saved now; "" if it can. */
  #why() {
    if (!this.#history?.isChanged) return t("floor.no_change");
    if (this.#problems.length) return t("floor.problems", { n: this.#problems.length });
    if (!this.#isChecked) return t("floor.checking");
    if (!this.#known.is_writable) return t("floor.not_here");
    return this.#battles ? t("desk.check_battle") : "";
  }

  #showState() {
    if (!this.#history) return;
    const why = this.#why();
    byId("floor-save").setAttribute("aria-disabled", why !== "");
    setText(byId("floor-state"), why || t("desk.not_saved"));
  }
}

function download(plan, name) {
  const url = URL.createObjectURL(new Blob([plans.toFile(plan)], { type: "application/json" }));
  element("a", { href: url, download: name }).click();
  setTimeout(() => URL.revokeObjectURL(url), 1000);
}
