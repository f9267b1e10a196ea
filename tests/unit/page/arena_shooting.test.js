import assert from "node:assert/strict";
import { test } from "node:test";
import { Shooting } from "../../../server/static/js/arena/shooting.js";
import { hit, player, status } from "./samples.js";

const robots = [0, 1].map((id) => ({ id, name: `Robot${id}`, x: 0, y: 0, heading: 0 }));
const users = [player("al", { robot: 0 }), player("bo", { robot: 1 })];
const battle = (...events) => status({ game: 2, battle: 1, users, events });

test("a shot shines for a moment", () => {
  const shooting = new Shooting();
  const beams = (now) => shooting.on(robots, now).map(({ beam }) => beam);
  assert.deepEqual(beams(0), [false, false]);
  shooting.shoot(1, 10);
  assert.deepEqual(beams(10.1), [false, true]);
  assert.deepEqual(beams(11), [false, false]);
});

test("hits count at the robot of who was hit, and those of before the page was opened do not", () => {
  const shooting = new Shooting();
  const hits = () => shooting.on(robots, 0).map((robot) => robot.hits);
  assert.equal(shooting.take(battle(hit(1, "al", "bo", 90))), false);
  assert.deepEqual(hits(), [0, 0]);
  assert.equal(shooting.take(battle(hit(1, "al", "bo", 90), hit(2, "al", "bo", 80), hit(3, "", "al", 90))), true);
  assert.deepEqual(hits(), [1, 1]);
  assert.equal(shooting.take(battle(hit(3, "", "al", 90))), false);
  assert.deepEqual(hits(), [1, 1]);
});
