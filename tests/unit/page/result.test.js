import assert from "node:assert/strict";
import { test } from "node:test";
import { outcomeOf, statsTexts } from "../../../server/static/js/game/result.js";
import { OwnStats } from "../../../server/static/js/game/own_stats.js";
import { player, status } from "./samples.js";

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

test("what a player did is counted from battle to battle", () => {
  let now = 1000;
  const stats = new OwnStats("Ann", () => now);
  const at = (game, battle, life) => status({ game, battle, users: [player("Ann", { ready: true, life })] });
  const playing = at(2, 1, 100);
  stats.take(at(1, 0, 100), playing);
  stats.shot();
  now = 4000;
  stats.take(playing, at(2, 1, 90));
  stats.take(at(2, 1, 90), at(2, 1, 0));
  now = 9000;
  stats.take(at(2, 1, 0), at(0, 1, 0));
  assert.deepEqual(stats.values, { hits: 2, shots: 1, seconds: 3 }, "the time until one is out counts");
  stats.take(at(1, 1, 100), at(2, 2, 100));
  now = 10_000;
  assert.deepEqual(stats.values, { hits: 0, shots: 0, seconds: 1 });
});

test("it is said in the right number", () => {
  assert.deepEqual(statsTexts({ hits: 1, shots: 12, seconds: 65 }), ["1 hit taken", "12 shots fired", "1:05 in the battle"]);
});

test("where the light tells who has shot, the referee's count is told", () => {
  const stats = { hits: 1, shots: 12, seconds: 65 };
  assert.deepEqual(statsTexts(stats, player("Ann", { shots: 9, hits: 3, kills: 1 })), [
    "1 hit taken", "9 shots fired", "3 of them hit", "accuracy 33%", "1 robot taken out", "1:05 in the battle",
  ]);
  assert.deepEqual(statsTexts(stats, player("Ann")), ["1 hit taken", "0 shots fired", "1:05 in the battle"]);
});
