import assert from "node:assert/strict";
import { afterEach, test } from "node:test";
import { dateTime, list, number, percent, setWords, t } from "../../../server/static/js/common/words.js";
import { speak } from "./samples.js";

afterEach(() => speak("en"));

test("places are filled, numbers as the language writes them", () => {
  setWords({ a: { b: "{name} has {n}", c: { one: "{n} Treffer!", other: "{n} Treffer" } } }, "de");
  assert.equal(t("a.b", { name: "Al", n: 1234.5 }), "Al has 1.234,5");
  assert.deepEqual([t("a.c", { n: 1 }), t("a.c", { n: 0 })], ["1 Treffer!", "0 Treffer"]);
});

test("words that are not there are a fault of the page", () => {
  assert.throws(() => t("a.nothing"), /no words for a\.nothing/);
});

test("numbers, parts and moments follow the language", () => {
  assert.deepEqual([number(0.5), percent(40)], ["0.5", "40%"]);
  speak("it");
  assert.equal(number(0.5), "0,5");
  assert.match(dateTime(new Date(2026, 10, 24, 20, 30)), /24 nov 2026, 20:30/);
  assert.equal(list(["Al", "Bo", "Cy"]), "Al, Bo e Cy");
});
