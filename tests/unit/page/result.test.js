import assert from "node:assert/strict";
import { test } from "node:test";
import { outcomeOf, statsTexts } from "../../../server/static/js/game/result.js";
import { player } from "./samples.js";

const result = [
  player("Bob", { place: 1, life: 40, avatar: 3 }),
  player("Ann", { place: 2, life: 0 }),
  player("Zed", { place: 3, life: 70, left: true }),
];

test("the first wins, everybody else loses at his place", () => {
  assert.deepEqual(outcomeOf(result, "Bob"), { outcome: "win", title: "YOU WIN!", text: "Your place is 1." });
  assert.deepEqual(outcomeOf(result, "Ann"), { outcome: "lose", title: "YOU LOST!", text: "Your place is 2." });
});

test("who shares the first place has a draw, who shares another has lost", () => {
  const tied = [player("Ann", { place: 1 }), player("Bob", { place: 1 }), player("Eve", { place: 3 }), player("Zed", { place: 3 })];
  assert.deepEqual(outcomeOf(tied, "Ann"), { outcome: "draw", title: "DRAW!", text: "You share place 1." });
  assert.deepEqual(outcomeOf(tied, "Eve"), { outcome: "lose", title: "YOU LOST!", text: "You share place 3." });
});

test("what a player did is told as the referee has counted it, in the right number", () => {
  const ann = player("Ann", { taken: 1, seconds: 65, shots: 9, hits: 3, kills: 1 });
  assert.deepEqual(statsTexts(ann, true), [
    "1 hit taken", "9 shots fired", "3 of them hit", "accuracy 33%", "1 robot taken out", "1:05 in the battle",
  ]);
  assert.deepEqual(statsTexts(player("Ann", { taken: 2, seconds: 65 }), true), ["2 hits taken", "0 shots fired", "1:05 in the battle"]);
});

test("where the light does not tell who has shot, nothing is said of it", () => {
  assert.deepEqual(statsTexts(player("Ann", { taken: 1, seconds: 65, shots: 9 }), false), ["1 hit taken", "1:05 in the battle"]);
});
