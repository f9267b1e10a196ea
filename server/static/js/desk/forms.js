// The desk's forms: what the server says fills them, but never over what somebody has typed.

import { element, setText } from "../common/dom.js";
import { rowButton, showRows } from "./rows.js";
import * as words from "./rule_words.js";
import { parseWords } from "./words.js";
import { list, t } from "../common/words.js";

const byId = (id) => document.getElementById(id);

/** The rules, one row each, under the titles of their groups. */
export class RulesForm {
  #rules = {};
  #onReset;

  /** @param {(name: string) => void} onReset give a rule its default again */
  constructor(onReset) {
    this.#onReset = onReset;
    byId("rules-form").addEventListener("input", () => this.#showChanged());
  }

  /** The rules that the server does not know yet. */
  get changed() {
    const wanted = Object.keys(this.#rules).map((name) => [name, valueOf(field(name))]);
    return words.changedRules(Object.fromEntries(wanted), this.#rules);
  }

  show(rules) {
    const before = this.#rules;
    this.#rules = rules;
    showRows(byId("rules-rows"), words.groupedRules(rules), {
      key: ({ group, name }) => (group ? `group ${group}` : name),
      make: ({ group, name, rule }) => (group ? element("h3", {}, t(`desk.group_${group}`)) : this.#row(name, rule)),
      fill: (row, { name, rule }) => name && this.#fill(row, name, rule, before[name]),
    });
    this.#showChanged();
  }

  #fill(row, name, { value, default: standard, idle }, before) {
    const input = field(name, row);
    if (!before || valueOf(input) === before.value) setValue(input, value);
    row.classList.toggle("is-other", value !== standard);
    row.querySelector(".rule-note").hidden = !idle;
    row.querySelector("button").hidden = value === standard;
    setText(row.querySelector("button span"), t("desk.reset_to", { value: words.valueText(standard) }));
  }

  /** Forget what somebody has typed for these rules. */
  forget(...names) {
    for (const name of names) setValue(field(name), this.#rules[name].value);
  }

  #row(name, rule) {
    const input = inputOf(rule);
    input.id = `rule-${name}`;
    if (rule.min !== null) Object.assign(input, { min: rule.min, max: rule.max, inputMode: "decimal" });
    input.setAttribute("aria-describedby", `rule-${name}-text rule-${name}-note`);
    const onclick = () => {
      input.focus(); // the button goes
      this.#onReset(name);
    };
    const reset = rowButton("", words.ruleName(name), onclick);
    const { meaning, bounds } = words.ruleText(rule);
    return element(
      "div",
      { className: "rule" },
      element("label", { htmlFor: input.id }, words.ruleName(name)),
      element("div", { className: "rule-value" }, input, reset),
      element("p", { id: `rule-${name}-text`, className: "muted" }, element("span", { lang: "en" }, meaning), ` ${bounds}`),
      element("p", { id: `rule-${name}-note`, className: "rule-note", hidden: true }, t("desk.places_unknown")),
    );
  }

  #showChanged() {
    const names = Object.keys(this.changed);
    setText(byId("rules-changed"), names.length ? t("desk.rules_changed", { names: list(names.map(words.ruleName)) }) : "");
    for (const name of Object.keys(this.#rules)) field(name).closest(".rule").classList.toggle("is-changed", names.includes(name));
  }
}

/** The control for a rule's value: one of its words, yes or no, or a number. */
function inputOf({ value, words: choices }) {
  if (choices.length > 0) return element("select", {}, ...choices.map((word) => element("option", { value: word }, word)));
  if (typeof value === "boolean") return element("input", { type: "checkbox" });
  return element("input", { type: "number", step: "any", required: true });
}

const field = (name, row = document) => row.querySelector(`#rule-${name}`);
function valueOf(input) {
  if (input.type === "checkbox") return input.checked;
  return input.type === "number" ? input.valueAsNumber : input.value;
}

function setValue(input, value) {
  if (Object.is(valueOf(input), value)) return; // "1." is 1: nobody's typing is disturbed
  if (input.type === "checkbox") input.checked = value;
  else input.value = String(value);
}

/** The list of forbidden words. */
export class WordsForm {
  #words = [];

  constructor() {
    byId("forbidden").addEventListener("input", () => this.#showChanged());
  }

  get words() {
    return parseWords(byId("forbidden").value);
  }

  get #isChanged() {
    return this.words.join("\n") !== this.#words.join("\n");
  }

  show(forbidden) {
    const wasChanged = this.#isChanged;
    this.#words = forbidden;
    if (!wasChanged && this.#isChanged) byId("forbidden").value = forbidden.join("\n");
    this.#showChanged();
  }

  #showChanged() {
    setText(byId("words-changed"), this.#isChanged ? t("desk.not_saved") : "");
  }
}
