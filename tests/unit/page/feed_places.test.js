import assert from "node:assert/strict";
import { test } from "node:test";
import { PlaceNews } from "../../../server/static/js/battle/feed_places.js";
import { COUNTDOWN, PLAYING } from "../../../server/static/js/battle/state.js";
import { player, status } from "./samples.js";

/** A state with Al and Bo so. */
const state = (al = {}, bo = {}, values = {}) => {
  const users = [player("Al", { ready: true, ...al }), player("Bo", { ready: true, robot: 1, ...bo })];
  return status({ game: PLAYING, battle: 4, time_left: 100, users, ...values });
};

/** "kind name" of what is told from each state to the next. */
function told(...states) {
  const news = new PlaceNews();
  return states.flatMap((current, index) => news.take(states[index - 1] ?? null, current).map(({ kind, name }) => `${kind} ${name}`));
}

/** The battle with these points of Al and Bo from second to second. */
const hill = (points, values = {}) => points.map(([al, bo], second) => state({ points: al, ...values }, { points: bo, ...values }, { time_left: 100 - second }));

test("what is picked up is told once, and its end not", () => {
  assert.deepEqual(told(state({ life: 40 }), state({ life: 70 }), state({ life: 70 })), ["repair Al"]);
  assert.deepEqual(told(state(), state({ effects: 1 }), state({ effects: 3 }), state({ effects: 2 }), state()), ["shield Al", "double_damage Al"]);
});

test("a hill is told when somebody takes it, not each second", () => {
  assert.deepEqual(told(...hill([[0, 0], [1, 0], [2, 0], [3, 0]])), ["hill Al"]);
  assert.deepEqual(told(...hill([[0, 0], [1, 0], [2, 0], [2, 1], [2, 2], [2, 3], [3, 3], [4, 3]])), ["hill Al", "hill Bo", "hill Al"]);
});

test("a team holds a hill together", () => {
  assert.deepEqual(told(...hill([[0, 0], [1, 0], [1, 1], [2, 1], [2, 2]], { team: 1 })), ["hill Al"]);
});

test("who pushes against the edge is told once in a while", () => {
  const stopped = (time_left) => state({ fence: 1 }, {}, { time_left });
  const free = (time_left) => state({}, {}, { time_left });
  assert.deepEqual(told(free(100), stopped(99), free(95), stopped(90), free(85), stopped(80)), ["fenced Al"]);
  assert.deepEqual(told(free(100), stopped(99), free(95), stopped(80)), ["fenced Al", "fenced Al"]);
});

test("only who fights in the same battle is told of", () => {
  const gained = { life: 100, effects: 1, points: 1, fence: 1 };
  const begun = { game: COUNTDOWN, battle: 3 };
  assert.deepEqual(told(state(gained)), []);
  assert.deepEqual(told(state({ life: 20 }, {}, begun), state(gained)), []);
  assert.deepEqual(told(state({ life: 20 }, {}, { battle: 3 }), state(gained)), []);
  assert.deepEqual(told(state({ life: 20, ready: false }), state(gained)), [], "has joined just now");
  assert.deepEqual(told(state({ ready: false }), state({ ready: false, fence: 1 })), []);
});
