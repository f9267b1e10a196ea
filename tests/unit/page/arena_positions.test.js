import assert from "node:assert/strict";
import { test } from "node:test";
import { Covered } from "../../../server/static/js/arena/covered.js";
import { Motion } from "../../../server/static/js/arena/motion.js";
import { readPositions } from "../../../server/static/js/arena/positions.js";
import { Presence } from "../../../server/static/js/arena/presence.js";

const seen = (robot, values = {}) => ({ robot, x: 0.5, y: 0.25, heading: 1, ...values });
const positions = (values = {}) => ({ width: 2, height: 1, walls: [0, 0, 2, 0, 2, 0, 2, 1], robots: [seen(3)], ...values });

test("a message has the floor with its walls, and the robots by their IDs", () => {
  const { floor, robots } = readPositions(positions());
  assert.deepEqual([floor.width, floor.height, floor.walls], [2, 1, [[0, 0, 2, 0], [2, 0, 2, 1]]]);
  assert.ok(floor.robot_radius > 0 && floor.beam_range > floor.robot_radius && floor.beam_half_angle > 0);
  assert.deepEqual(robots, [{ id: 3, name: "Robot3", x: 0.5, y: 0.25, heading: 1, covered: false }]);
  assert.deepEqual(readPositions(positions({ robots: [seen(3), seen(4)] }), [4]).robots.map(({ covered }) => covered), [false, true]);
  assert.deepEqual(readPositions(positions({ robots: [] })).robots, []);
});

test("without a floor there is nothing, what is no place or no wall is left out, and a robot is at one place", () => {
  for (const values of [{ width: 0 }, { height: -1 }, { width: null }, { width: 1e9 }]) assert.equal(readPositions(positions(values)), null);
  const robots = [seen(1, { x: null }), seen(1), seen(1, { x: 9 }), seen(2, { heading: null })];
  assert.deepEqual(readPositions(positions({ robots })).robots.map(({ id, x }) => [id, x]), [[1, 0.5]]);
  assert.deepEqual(readPositions(positions({ walls: [0, 0, 1, 1, 5, 5, null, 5, 7] })).floor.walls, [[0, 0, 1, 1]]);
  const crowd = Array.from({ length: 10_000 }, (_, n) => seen(n));
  assert.equal(readPositions(positions({ robots: crowd })).robots.length, 128);
});

test("robots are covered only as long as somebody may say so", () => {
  const covered = new Covered();
  assert.deepEqual(covered.at(0), []);
  covered.hear([4], 10_000);
  assert.deepEqual([covered.at(11_400), covered.at(11_600)], [[4], []]);
  covered.hear([], 12_000);
  assert.deepEqual(covered.at(12_100), []);
});

const at = (x, values = {}) => [{ id: 0, name: "Robot0", x, y: 0, heading: 0, ...values }];
const RATE = 1 / 15; // s
const LATE = [0, 25, -20, 10, 5, -15, 20, 0, -25, 15]; // ms that positions are off their beat

/** Robots that drive 1 m/s and are seen for so many s, each as late as `late` says. */
function drive(seconds, late = () => 0, gap = RATE) {
  const motion = new Motion();
  let n = 0;
  for (; n * gap < seconds; n++) motion.add(at(n * gap), n * gap + late(n) / 1000);
  return { motion, now: (n - 1) * gap };
}

test("the picture follows closely, and farther behind when positions are rarer", () => {
  for (const [gap, most] of [[RATE, 0.1], [0.1, 0.13], [0.2, 0.24]]) {
    const { motion, now } = drive(6, () => 0, gap);
    const behind = now - motion.at(now)[0].x;
    assert.ok(behind > gap / 2 && behind < most, `${gap}: ${behind}`);
  }
});

test("motion is smooth though the network delays some positions more than others", () => {
  const motion = new Motion();
  const steps = [];
  for (let n = 0, next = 0, last; n < 600; n++) {
    const now = n / 60;
    while (next * RATE + LATE[next % LATE.length] / 1000 <= now) motion.add(at(next++ * RATE), now);
    const { x } = motion.at(now)[0] ?? {};
    if (n > 300) steps.push(x - last);
    last = x;
  }
  const [least, most] = [Math.min(...steps) * 60, Math.max(...steps) * 60]; // m/s
  assert.ok(least > 0.6 && most < 1.4, `from ${least} to ${most} m/s`);
});

test("a robot of which nothing is heard goes on for a moment and then stands", () => {
  const { motion, now } = drive(3);
  const places = [0.1, 0.15, 0.4, 5].map((later) => motion.at(now + later)[0].x - now);
  assert.ok(places[0] > 0 && places[1] > places[0] && places[2] < 0.12, places.join());
  assert.equal(places[3], places[2]);
});

test("after a pause the robots are where they are, and turns go the short way", () => {
  const { motion, now } = drive(2);
  motion.add(at(7), now + 30);
  assert.equal(motion.at(now + 30)[0].x, 7);
  const turning = new Motion();
  turning.add(at(0, { heading: 3 }), 0);
  turning.add(at(0, { heading: -3 }), RATE);
  const { heading } = turning.at(1.5 * RATE + 0.02)[0];
  assert.ok(heading > 3 && heading < 2 * Math.PI - 3, `${heading}`);
  assert.deepEqual(new Motion().at(1), []);
});

test("a robot that comes or goes does so without the way between", () => {
  const motion = new Motion();
  motion.add(at(1), 0);
  motion.add([...at(1), { id: 1, name: "Robot1", x: 5, y: 5, heading: 0 }], RATE);
  assert.deepEqual(motion.at(1.5 * RATE).map(({ id, x }) => [id, x]), [[0, 1], [1, 5]]);
});

test("that nothing tells where the robots are is said after a moment, and that it tells no more, too", () => {
  const presence = new Presence(0);
  const state = (now) => (presence.look(now), presence.state);
  assert.deepEqual([state(1500), state(2000), state(60_000)], ["connecting", "none", "none"]);
  presence.hear(61_000);
  assert.equal(presence.state, "live");
  assert.deepEqual([state(62_500), state(63_900), state(64_000)], ["live", "live", "lost"]);
  presence.hear(70_000);
  assert.equal(presence.state, "live");
});

test("a page that was too busy to hear anything misses nothing yet", () => {
  const presence = new Presence(0);
  presence.hear(500);
  presence.look(1000);
  presence.look(60_000);
  assert.equal(presence.state, "live");
  for (let now = 60_500; now <= 63_000; now += 500) presence.look(now);
  assert.equal(presence.state, "lost");
});
