import assert from "node:assert/strict";
import { beforeEach, test } from "node:test";
import { Loop } from "../../../sim/static/loop.js";
import { DRIFT, isDue, isOther, MOTION, REST } from "../../../sim/static/pace.js";

const ARENA = { robot_radius: 0.075, beam_range: 2 };
const SCALE = 300; // pixels for a metre
const robot = (values = {}) => ({ name: "virtual0", id: 0, x: 1, y: 1, heading: 3, beam: false, lit: false, hits: 0, ...values });
const isSeen = (before, after) => isOther([robot(before)], [robot(after)], ARENA, SCALE);

test("a robot that has not moved by half a pixel is the same picture", () => {
  assert.equal(isSeen({}, {}), false);
  assert.equal(isSeen({}, { x: 1.001, y: 1.001 }), false);
  assert.equal(isSeen({}, { x: 1.0015, y: 1.0015 }), true);
});

test("so is one whose edge has not turned by half a pixel, over the end of the circle, too", () => {
  assert.equal(isSeen({ heading: Math.PI - 0.005 }, { heading: -Math.PI + 0.005 }), false);
  assert.equal(isSeen({}, { heading: 3.03 }), true);
});

test("a beam is long: its end is seen to move sooner", () => {
  assert.equal(isSeen({ beam: true }, { beam: true, heading: 3.005 }), true);
});

test("light, hits and other robots are another picture", () => {
  for (const news of [{ beam: true }, { lit: true }, { hits: 1 }, { id: 7 }, { name: "virtual1" }]) assert.equal(isSeen({}, news), true);
  assert.equal(isOther([robot()], [], ARENA, SCALE), true);
});

test("what goes on is drawn so often as it is worth, what rests never", () => {
  assert.equal(isDue(REST, Infinity), false);
  assert.equal(isDue(DRIFT, 1 / 30), false);
  assert.equal(isDue(DRIFT, 1 / 15), true);
  assert.equal(isDue(MOTION, 1 / 60), true);
});

let loop, screen, now, timers, seen, intervals;

beforeEach(() => {
  [screen, timers, seen, intervals, now] = [[], [], [], [], 0];
  const world = {
    nextPicture: (act) => screen.push(act),
    later: (ms, act) => timers.push({ at: now + ms, act }),
    now: () => now,
  };
  loop = new Loop((time, interval) => {
    seen.push([time, interval]);
    return intervals.shift() ?? null;
  }, world);
});

/** Let so many pictures of a screen of so many a second pass. */
function pass(pictures, rate = 60) {
  for (let n = 0; n < pictures; n++) {
    const due = timers.filter(({ at }) => at <= now + 1000 / rate);
    timers = timers.filter((timer) => !due.includes(timer));
    for (const { act } of due) act();
    now += 1000 / rate;
    for (const draw of screen.splice(0)) draw(now);
  }
}

test("nothing is asked of the screen before there is news, nor after a picture that wants no other", () => {
  pass(10);
  assert.deepEqual(seen, []);
  loop.wake();
  loop.wake();
  pass(10);
  assert.equal(seen.length, 1);
  assert.equal(seen[0][1], null);
  loop.wake();
  pass(10);
  assert.equal(seen.length, 2);
});

test("the screen is asked for so many pictures as are wanted, whatever its own rate is", () => {
  for (const [rate, wanted, least, most] of [[60, 60, 59, 61], [60, 30, 29, 31], [50, 30, 24, 26], [144, 30, 28, 37], [60, 15, 14, 16]]) {
    seen = [];
    intervals = Array(wanted * 2).fill(1000 / wanted);
    loop.wake();
    pass(rate, rate);
    assert.ok(seen.length >= least && seen.length <= most, `${seen.length} of ${wanted} pictures on a screen of ${rate}`);
    intervals = [];
    pass(rate, rate);
  }
});

test("a picture that the screen offers too soon is left out", () => {
  intervals = [1000 / 30, 1000 / 30];
  loop.wake();
  pass(1);
  const [{ at, act }] = timers.splice(0);
  now = at;
  act();
  for (const draw of screen.splice(0)) draw(now - 9); // it is late
  assert.equal(seen.length, 1);
  for (const draw of screen.splice(0)) draw(now + 8);
  assert.equal(seen.length, 2);
});

test("a picture is told after how long it was wanted", () => {
  intervals = [50, 100];
  loop.wake();
  pass(30);
  assert.deepEqual(seen.map(([, interval]) => interval), [null, 50, 100]);
});
