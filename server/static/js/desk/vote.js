// The desk's part in the audience's vote: what there is to choose from, how it stands, and what it comes to.

import { askAudience, leading } from "../common/audience.js";
import { element, setText } from "../common/dom.js";
import { presetName } from "../common/preset_names.js";
import { list, t } from "../common/words.js";
import { showRows } from "./rows.js";

const POLL = 1000; // ms

const byId = (id) => document.getElementById(id);
const keyOf = ({ name, own }) => `${own ? "own" : "built-in"} ${name}`;

export class AudienceVote {
  #presets = [];
  #on;

  /** @param {{open: (choices: object[], seconds: number) => void, apply: (preset: object) => void}} on `open` without choices ends the vote */
  constructor(on) {
    this.#on = on;
    byId("vote-form").addEventListener("submit", (event) => {
      event.preventDefault();
      const choices = this.#presets.filter((preset) => this.#box(preset)?.checked);
      setText(byId("vote-problem"), choices.length < 2 ? t("desk.vote_none") : "");
      if (choices.length >= 2) on.open(choices.map(({ name, own }) => ({ name, own })), byId("vote-seconds").valueAsNumber);
    });
    byId("vote-end").addEventListener("click", () => on.open([]));
  }

  start() {
    setInterval(() => document.hidden || this.ask(), POLL);
  }

  /** @param {object[]} presets as the state has them */
  show(presets) {
    this.#presets = presets;
    showRows(byId("vote-presets"), presets, {
      key: keyOf,
      make: (preset) => element("li", {}, element("label", {}, element("input", { type: "checkbox" }), ` ${presetName(preset)}`)),
    });
  }

  async ask() {
    const { vote } = await askAudience().catch(() => ({ vote: null }));
    const isOpen = vote !== null && vote.seconds_left > 0;
    byId("vote-now").hidden = vote === null;
    byId("vote-end").hidden = !isOpen;
    if (!vote) return;
    setText(byId("vote-state"), isOpen ? t("desk.vote_left", { n: Math.ceil(vote.seconds_left) }) : t("desk.vote_done"));
    const counts = vote.choices.map((choice) => `${presetName(choice)}: ${t("audience.votes", { n: choice.votes })}`);
    setText(byId("vote-counts"), list(counts));
    this.#showApply(isOpen ? [] : leading(vote));
  }

  #showApply(winners) {
    const current = (wanted) => this.#presets.find((preset) => keyOf(preset) === keyOf(wanted)); // it may be saved anew
    const chosen = winners.filter(current);
    const wanted = chosen.map(keyOf).join();
    const box = byId("vote-apply");
    if (box.dataset.shown === wanted) return;
    box.dataset.shown = wanted;
    const button = (preset) => element("button", { type: "button", className: "button", onclick: () => this.#on.apply(current(preset)) }, t("desk.vote_apply", { name: presetName(preset) }));
    box.replaceChildren(...chosen.map(button));
  }

  #box(preset) {
    return byId("vote-presets").querySelector(`[data-key="${CSS.escape(keyOf(preset))}"] input`);
  }
}
