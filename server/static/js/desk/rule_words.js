// The rules in words: their names and groups, what they mean, what a form or a preset wants otherwise. Pure.

import { number, t } from "../common/words.js";

/** The groups, in the order of the desk, with what belongs to them; what is in none belongs to the game. */
const GROUPS = {
  battle: ["countdown", "battle_limit", "hit_damage", "protection", "late_join", "handicap", "fence", "hill", "pickups"],
  seats: ["seats", "battles_in_row", "seat_minutes", "idle", "offer", "player_timeout", "seat_timeout"],
  light: ["light", "light_damage", "line_of_fire"],
  game: ["teams", "friendly_fire", "practice"],
  cameras: ["hide_cameras"],
};
const OTHERS = "game";

/** A rule's name for people. */
export const ruleName = (key) => t(`desk.rule_${key}`);

const sentence = (text) => text.charAt(0).toUpperCase() + text.slice(1);

/** A rule's value for people. */
export function valueText(value) {
  if (typeof value === "boolean") return t(value ? "desk.on" : "desk.off");
  return typeof value === "number" ? number(value) : value;
}

/**
 * What a rule means, which values it takes and which is its default.
 * @returns {{meaning: string, bounds: string}} the meaning is the server's, in English
 */
export function ruleText({ default: standard, min, max, text }) {
  const range = min === null ? "" : `${t("desk.rule_range", { min, max })} `;
  // an environment's flag is 0 or 1, the desk's a box; the server's text is Markdown
  const meaning = text.replace(/^1: /, "").replaceAll("`", "");
  return { meaning: `${sentence(meaning)}.`, bounds: `${range}${t("desk.rule_default", { value: valueText(standard) })}` };
}

/**
 * The lines of the form: each group's title, then its rules.
 * @param {Record<string, object>} rules
 * @returns {({group: string}|{name: string, rule: object})[]}
 */
export function groupedRules(rules) {
  const known = new Set(Object.values(GROUPS).flat());
  const rest = Object.keys(rules).filter((name) => !known.has(name));
  return Object.entries(GROUPS).flatMap(([group, names]) => {
    const here = [...names.filter((name) => name in rules), ...(group === OTHERS ? rest : [])];
    return here.length ? [{ group }, ...here.map((name) => ({ name, rule: rules[name] }))] : [];
  });
}

/**
 * The rules that a form wants otherwise than they are.
 * @param {Record<string, number|boolean|string>} wanted
 * @param {Record<string, {value: number|boolean|string}>} rules
 */
export function changedRules(wanted, rules) {
  return Object.fromEntries(Object.entries(wanted).filter(([name, value]) => rules[name].value !== value));
}

/**
 * Whether all that a preset says holds now.
 * @param {{rules: Record<string, number|boolean|string|null>}} preset null: the rule's default
 */
export function isPresetOn({ rules: wanted }, rules) {
  return Object.entries(wanted).every(([name, value]) => !(name in rules) || rules[name].value === (value ?? rules[name].default));
}
