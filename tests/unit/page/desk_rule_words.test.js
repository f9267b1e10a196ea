import assert from "node:assert/strict";
import { afterEach, test } from "node:test";
import { speak } from "./samples.js";
import * as words from "../../../server/static/js/desk/rule_words.js";

afterEach(() => speak("en"));

const rule = (values) => ({ value: 10, default: 10, min: 1, max: 100, text: "life (of 100) that a hit takes", ...values });

test("a rule is named, explained and bounded", () => {
  assert.equal(words.ruleName("battles_in_row"), "Battles in a row");
  assert.deepEqual(words.ruleText(rule()), { meaning: "Life (of 100) that a hit takes.", bounds: "From 1 to 100. Default: 10." });
  const flag = rule({ default: false, min: null, max: null, text: "1: all may" });
  assert.deepEqual(words.ruleText(flag), { meaning: "All may.", bounds: "Default: off." });
  assert.equal(words.ruleText(rule({ text: "what a shot is: `plain`, `coded`" })).meaning, "What a shot is: plain, coded.");
});

test("only the rules that differ are sent", () => {
  const rules = { hit_damage: rule(), countdown: rule({ value: 15 }), practice: rule({ value: false }) };
  assert.deepEqual(words.changedRules({ hit_damage: 10, countdown: 5, practice: true }, rules), { countdown: 5, practice: true });
  assert.deepEqual(words.changedRules({ hit_damage: 10, countdown: 15, practice: false }, rules), {});
});

test("a rule whose values are words", () => {
  assert.equal(words.ruleText({ ...rule(), default: "plain", min: null, max: null }).bounds, "Default: plain.");
  assert.deepEqual(words.changedRules({ light: "coded" }, { light: rule({ value: "plain" }) }), { light: "coded" });
});

test("a rule's bounds are in the page's language", () => {
  speak("de");
  assert.equal(words.ruleText(rule({ min: 0.5, max: 9, default: 2.5 })).bounds, "Von 0,5 bis 9. Standard: 2,5.");
});

test("rules stand in their groups, one that nobody has sorted in with the game", () => {
  const rules = { hide_cameras: rule(), new_one: rule(), teams: rule(), seats: rule(), countdown: rule() };
  const lines = words.groupedRules(rules).map(({ group, name }) => (group ? `${group}:` : name));
  assert.deepEqual(lines, ["battle:", "countdown", "seats:", "seats", "game:", "teams", "new_one", "cameras:", "hide_cameras"]);
  assert.equal(words.groupedRules(rules).find(({ name }) => name === "seats").rule, rules.seats);
});

test("a preset is on while all that it says holds", () => {
  const rules = { hit_damage: rule({ value: 5 }), practice: rule({ value: false, default: false }), idle: rule({ value: 60 }) };
  const isOn = (wanted) => words.isPresetOn({ rules: wanted }, rules);
  assert.equal(isOn({ hit_damage: 5, practice: null }), true);
  assert.equal(isOn({ hit_damage: null }), false);
  assert.equal(isOn({ hit_damage: 5, practice: true }), false);
  assert.equal(isOn({ idle: 60, of_another_version: 3 }), true);
});

