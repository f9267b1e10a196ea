// The things on the floor as a list: all of them with what is wrong, and the fields of the one that is selected.

import { element, setText } from "../common/dom.js";
import { t } from "../common/words.js";
import * as plans from "./floor_plan.js";
import { nameOf, placeOf } from "./floor_words.js";
import { rowButton } from "./rows.js";

export class FloorList {
  #list;
  #on;
  #plan = null;

  /**
   * @param {HTMLElement} list
   * @param {{select: (thing: plans.Thing|null) => void, change: (plan: plans.Plan, key: string) => void, remove: (thing: plans.Thing) => void}} on
   */
  constructor(list, on) {
    this.#list = list;
    this.#on = on;
  }

  /**
   * @param {plans.Plan} plan
   * @param {plans.Thing|null} selected
   * @param {{about: string, error: string}[]} problems of things, and of other parts of the floor
   */
  show(plan, selected, problems) {
    this.#plan = plan;
    const rows = new Map([...this.#list.children].map((row) => [row.dataset.key, row]));
    const wanted = plans.thingsOf(plan).map((thing) => {
      const row = rows.get(plans.keyOf(thing)) ?? this.#row(thing);
      this.#fill(row, thing, plans.isSame(thing, selected), problems.filter(({ about }) => about === plans.keyOf(thing)));
      return row;
    });
    if (wanted.length !== rows.size || wanted.some((row, n) => row !== this.#list.children[n])) this.#list.replaceChildren(...wanted);
  }

  /** Bring a thing's row into sight, without scrolling the page. @param {plans.Thing} thing */
  reveal(thing) {
    const row = this.#rowOf(thing);
    if (!row) return;
    const [{ top, bottom }, box] = [row.getBoundingClientRect(), this.#list.getBoundingClientRect()];
    if (top < box.top || bottom > box.bottom) this.#list.scrollTop += top - box.top;
  }

  #rowOf(thing) {
    return [...this.#list.children].find(({ dataset }) => dataset.key === plans.keyOf(thing));
  }

  #row(thing) {
    const toggle = element("button", { type: "button", className: "floor-name" }, element("b"), element("span", { className: "muted" }));
    toggle.addEventListener("click", () => this.#on.select(toggle.ariaExpanded === "true" ? null : thing));
    const error = element("p", { className: "floor-error", lang: "en", hidden: true });
    const fields = element("div", { className: "floor-fields", hidden: true });
    const row = element("li", {}, toggle, error, fields);
    row.dataset.key = plans.keyOf(thing);
    return row;
  }

  #fill(row, thing, isOpen, problems) {
    const [toggle, error, fields] = row.children;
    const [name, place] = toggle.children;
    setText(name, nameOf(this.#plan, thing));
    setText(place, placeOf(this.#plan, thing));
    toggle.ariaExpanded = String(isOpen);
    error.hidden = problems.length === 0;
    setText(error, problems.map((problem) => problem.error).join("; "));
    row.classList.toggle("is-wrong", problems.length > 0);
    fields.hidden = !isOpen;
    if (!isOpen) return;
    const wanted = plans.fieldsOf(this.#plan, thing);
    if (!fields.firstChild) fields.append(...wanted.map((field) => this.#field(thing, field)), this.#remove(thing));
    for (const [n, { value }] of wanted.entries()) {
      const input = fields.children[n].querySelector("input");
      const known = input.type === "number" ? input.valueAsNumber : input.value;
      if (!Object.is(known, value)) input.value = Number.isNaN(value) ? "" : value; // nobody's typing is disturbed
    }
  }

  #field(thing, { name, step }) {
    const input = element("input", step ? { type: "number", step: "any", inputMode: "decimal" } : { maxLength: 40, autocomplete: "off" });
    if (step) input.step = step;
    if (name === "heading") input.placeholder = t("floor.to_middle");
    input.addEventListener("input", () => {
      const value = step ? input.valueAsNumber : input.value;
      this.#on.change(plans.withField(this.#plan, thing, name, value), `field ${plans.keyOf(thing)} ${name}`);
    });
    return element("label", {}, element("span", {}, t(`floor.field_${name}`)), input);
  }

  #remove(thing) {
    return rowButton(t("floor.remove"), nameOf(this.#plan, thing), () => this.#on.remove(thing), "quiet");
  }
}
