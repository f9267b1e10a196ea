import assert from "node:assert/strict";
import { test } from "node:test";
import { hitsOf, newHits } from "../../../server/static/js/battle/hits.js";
import { fromReply } from "../../../server/static/js/battle/messages.js";
import { hit, player, status } from "./samples.js";

const battle = (life, events, values = {}) =>
  status({ game: 2, battle: 1, users: [player("Ann", { ready: true }), player("Bob", { ready: true, life })], events, ...values });
const numbers = (previous, current) => newHits(previous, current).map(({ number }) => number);
const byHttp = (life, previous) =>
  fromReply({ game: 2, timeLeft: 9, users: JSON.stringify([{ name: "Ann", life: 100, ready: 1, robot: 0 }, { name: "Bob", life, ready: 1, robot: 1 }]) }, previous);

const ALL = [hit(4, "Ann", "Bob", 90), hit(5, "Ann", "Bob", 80), hit(6, "Ann", "Bob", 70)];

test("a page that has just been opened knows no news", () => {
  assert.deepEqual(numbers(null, battle(70, ALL)), []);
});

test("each hit is news once, though states in between are missing", () => {
  assert.deepEqual(numbers(battle(100, []), battle(70, ALL)), [4, 5, 6]);
  assert.deepEqual(numbers(battle(90, ALL.slice(0, 1)), battle(70, ALL)), [5, 6]);
  assert.deepEqual(numbers(battle(70, ALL), battle(70, ALL.slice(1))), []);
});

test("all hits of another battle are news, also if the server counts anew", () => {
  assert.deepEqual(numbers(battle(0, [hit(40, "Ann", "Bob", 0)]), battle(70, ALL, { battle: 2 })), [4, 5, 6]);
});

test("a state that does not tell hits tells none, and what it tells by lives is no news later", () => {
  const before = battle(90, ALL.slice(0, 1));
  const reply = byHttp(80, before);
  assert.deepEqual(numbers(before, reply), []);
  assert.deepEqual(numbers(reply, battle(70, ALL)), [6]);
  assert.deepEqual(numbers(byHttp(100, null), battle(70, ALL)), [4, 5, 6], "the battle's number was unknown");
});

test("who was hit by whom concerns both, and a friend's misfortune is nothing to be proud of", () => {
  const users = [player("Ann", { team: 1 }), player("Bob", { team: 2 }), player("Cy", { team: 1 })];
  const hits = [hit(1, "Ann", "Bob", 90), hit(2, "Bob", "Ann", 90), hit(3, "Ann", "Cy", 90), hit(4, "", "Ann", 80)];
  const seen = (name, values = {}) => {
    const { given, taken } = hitsOf(hits, status({ game: 2, teams: 2, users, ...values }), name);
    return [given.map(({ number }) => number), taken.map(({ number }) => number)];
  };
  assert.deepEqual(seen("Ann"), [[1], [2, 4]]);
  assert.deepEqual(seen("Bob"), [[2], [1]]);
  assert.deepEqual(seen("Cy"), [[], [3]]);
  const chosenForTheNext = { game: 0, users: users.map((user) => ({ ...user, team: 1 })), result: users };
  assert.deepEqual(seen("Ann", chosenForTheNext), [[1], [2, 4]]);
});
