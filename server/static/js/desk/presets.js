// Sets of rules on the desk: one press makes them hold, and the present rules can be kept under a name.

import { element, setText } from "../common/dom.js";
import { presetName } from "../common/preset_names.js";
import { rowButton, showRows } from "./rows.js";
import { isPresetOn } from "./rule_words.js";
import { t } from "../common/words.js";

const byId = (id) => document.getElementById(id);

export class Presets {
  #on;
  #presets = [];

  /** @param {{apply: (preset: object) => void, save: (name: string) => void, remove: (preset: object) => void}} on */
  constructor(on) {
    this.#on = on;
    byId("preset-form").addEventListener("submit", (event) => {
      event.preventDefault();
      on.save(byId("preset-name").value.trim());
    });
  }

  show(presets, rules) {
    this.#presets = presets;
    showRows(byId("preset-rows"), presets, {
      key: ({ name, own }) => `${own ? "own" : "built-in"} ${name}`,
      make: (preset) => this.#row(preset),
      fill: (row, preset) => row.firstElementChild.setAttribute("aria-pressed", isPresetOn(preset, rules)),
    });
  }

  #row(preset) {
    const current = () => this.#presets.find(({ name, own }) => name === preset.name && own === preset.own);
    const apply = element("button", { type: "button", className: "button quiet", onclick: () => this.#on.apply(current()) });
    setText(apply, presetName(preset));
    const remove = preset.own && rowButton(t("desk.preset_remove"), preset.name, () => this.#on.remove(preset));
    return element("li", {}, apply, ...(remove ? [remove] : []));
  }
}
