import assert from "node:assert/strict";
import { beforeEach, test } from "node:test";
import { Driver } from "../../../server/static/js/drive/driver.js";
import { NEUTRAL } from "../../../server/static/js/drive/keys.js";

const FORWARD = { linear_x: 1, angular_z: 0, shoot: false };
const CURVE = { linear_x: 1, angular_z: 1, shoot: false };
const SHOT = { linear_x: 0, angular_z: 0, shoot: true };

let now, timers, sent, driver;

/** Let `ms` pass: the driver's own timers go off in their order. */
function pass(ms) {
  const end = now + ms;
  for (;;) {
    const due = [...timers].sort((one, other) => one.at - other.at)[0];
    if (!due || due.at > end) break;
    now = due.at;
    due.at += due.ms;
    due.act();
  }
  now = end;
}

/** What has been sent since the last call, as [ms, command]. */
function taken() {
  return sent.splice(0);
}

function makeDriver(interval) {
  return new Driver({
    send: (command) => sent.push([now, command]),
    every: (ms, act) => {
      const timer = { ms, act, at: now + ms };
      timers.add(timer);
      return () => timers.delete(timer);
    },
    interval,
  });
}

beforeEach(() => {
  now = 0;
  timers = new Set();
  sent = [];
  driver = makeDriver();
});

test("a stop opens the driving, then there is silence", () => {
  driver.start();
  pass(1000);
  assert.deepEqual(taken(), [[0, NEUTRAL]]);
});

test("a press is sent at once and repeated every 25 ms while held", () => {
  driver.start();
  pass(7);
  taken();
  driver.hold("KeyW", ["up"]);
  pass(60);
  assert.deepEqual(taken(), [[7, FORWARD], [32, FORWARD], [57, FORWARD]]);
});

test("the interval of the repeats can be chosen", () => {
  driver = makeDriver(50);
  driver.start();
  taken();
  driver.hold("KeyW", ["up"]);
  pass(110);
  assert.deepEqual(taken(), [[0, FORWARD], [50, FORWARD], [100, FORWARD]]);
});

test("a release sends one stop at once, then silence", () => {
  driver.start();
  driver.hold("KeyW", ["up"]);
  pass(30);
  taken();
  driver.release("KeyW");
  pass(1000);
  assert.deepEqual(taken(), [[30, NEUTRAL]]);
});

test("a tap shorter than the stream's beat still shoots", () => {
  driver.start();
  taken();
  driver.hold("Space", ["shoot"]);
  pass(3);
  driver.release("Space");
  pass(100);
  assert.deepEqual(taken(), [[0, SHOT], [3, NEUTRAL]]);
});

test("a second key changes the command at once and starts the beat anew", () => {
  driver.start();
  driver.hold("KeyW", ["up"]);
  pass(10);
  taken();
  driver.hold("KeyD", ["right"]);
  pass(25);
  assert.deepEqual(taken(), [[10, CURVE], [35, CURVE]]);
  driver.release("KeyD");
  assert.deepEqual(taken(), [[35, FORWARD]]);
});

test("the repeats of a held key are no changes", () => {
  driver.start();
  driver.hold("KeyW", ["up"]);
  taken();
  driver.hold("KeyW", ["up"]);
  assert.deepEqual(taken(), []);
});

test("the same direction by two keys lasts until both are released", () => {
  driver.start();
  driver.hold("KeyW", ["up"]);
  driver.hold("ArrowUp", ["up"]);
  taken();
  driver.release("KeyW");
  assert.deepEqual(taken(), []);
  driver.release("ArrowUp");
  assert.deepEqual(taken(), [[0, NEUTRAL]]);
});

test("opposite keys stop the robot, and there is no stream of stops", () => {
  driver.start();
  driver.hold("KeyW", ["up"]);
  taken();
  driver.hold("KeyS", ["down"]);
  pass(200);
  assert.deepEqual(taken(), [[0, NEUTRAL]]);
});

test("a thumb that slides over the pad replaces its own direction only", () => {
  driver.start();
  driver.hold("pad 1", ["up"]);
  driver.hold("fire 2", ["shoot"]);
  taken();
  driver.hold("pad 1", ["up", "right"]);
  assert.deepEqual(taken(), [[0, { linear_x: 1, angular_z: 1, shoot: true }]]);
});

test("losing the keyboard stops the robot at once, and a lost release later does nothing", () => {
  driver.start();
  driver.hold("KeyW", ["up"]);
  pass(10);
  taken();
  driver.releaseAll();
  pass(500);
  driver.release("KeyW");
  assert.deepEqual(taken(), [[10, NEUTRAL]]);
});

test("the end of the right to drive sends a stop, then nothing more", () => {
  driver.start();
  driver.hold("KeyW", ["up"]);
  pass(30);
  taken();
  driver.stop();
  pass(500);
  assert.deepEqual(taken(), [[30, NEUTRAL]]);
});

test("a key held at the end of one battle does not move the robot in the next", () => {
  driver.start();
  driver.hold("KeyW", ["up"]);
  driver.stop();
  taken();
  driver.start();
  pass(200);
  assert.deepEqual(taken(), [[0, NEUTRAL]]);
});

test("keys do nothing without the right to drive", () => {
  driver.hold("KeyW", ["up"]);
  driver.release("KeyW");
  driver.releaseAll();
  driver.stop();
  pass(200);
  assert.deepEqual(taken(), []);
});

test("to start twice is to start once", () => {
  driver.start();
  driver.hold("KeyW", ["up"]);
  taken();
  driver.start();
  assert.deepEqual(taken(), []);
  assert.deepEqual(driver.actions, new Set(["up"]));
});

test("whoever watches hears when the right to drive begins and ends, once each", () => {
  const told = [];
  driver.watch((driving) => told.push([driving, driver.driving]));
  driver.stop();
  driver.start();
  driver.start();
  driver.stop();
  driver.stop();
  assert.deepEqual(told, [[true, true], [false, false]]);
});
