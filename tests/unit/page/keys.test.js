import assert from "node:assert/strict";
import { test } from "node:test";
import { NEUTRAL, actionOf, commandOf, isNeutral, padActions } from "../../../server/static/js/drive/keys.js";

test("arrows and WASD move, Enter and Space fire", () => {
  const actions = {
    ArrowLeft: "left", KeyA: "left", ArrowUp: "up", KeyW: "up", ArrowRight: "right", KeyD: "right",
    ArrowDown: "down", KeyS: "down", Enter: "shoot", NumpadEnter: "shoot", Space: "shoot",
  };
  for (const [code, action] of Object.entries(actions)) assert.equal(actionOf({ code, key: "" }), action, code);
});

test("a key without a code is known by its letter, in either case", () => {
  assert.equal(actionOf({ code: "", key: "A" }), "left");
  assert.equal(actionOf({ key: "w" }), "up");
  assert.equal(actionOf({ key: " " }), "shoot");
});

test("other keys are no game keys", () => {
  for (const code of ["KeyQ", "Escape", "Tab", "ShiftLeft", "F5", "constructor"]) {
    assert.equal(actionOf({ code, key: code }), null, code);
  }
});

test("up and right go forward and to the right: left is -1, right is +1", () => {
  assert.deepEqual(commandOf(["up"]), { linear_x: 1, angular_z: 0, shoot: false });
  assert.deepEqual(commandOf(["down"]), { linear_x: -1, angular_z: 0, shoot: false });
  assert.deepEqual(commandOf(["left"]), { linear_x: 0, angular_z: -1, shoot: false });
  assert.deepEqual(commandOf(["right"]), { linear_x: 0, angular_z: 1, shoot: false });
  assert.deepEqual(commandOf(["up", "right", "shoot"]), { linear_x: 1, angular_z: 1, shoot: true });
});

test("opposite keys cancel", () => {
  assert.deepEqual(commandOf(["up", "down", "left", "right"]), NEUTRAL);
});

test("two keys for one direction are that direction", () => {
  assert.deepEqual(commandOf(["up", "up"]), { linear_x: 1, angular_z: 0, shoot: false });
});

test("only no movement and no shot is neutral", () => {
  assert.ok(isNeutral(commandOf([])));
  assert.ok(!isNeutral(commandOf(["shoot"])));
  assert.ok(!isNeutral(commandOf(["left"])));
});

test("a thumb on the pad steers in eight directions", () => {
  assert.deepEqual(padActions(0, -1), ["up"]);
  assert.deepEqual(padActions(0, 1), ["down"]);
  assert.deepEqual(padActions(-1, 0), ["left"]);
  assert.deepEqual(padActions(1, 0), ["right"]);
  assert.deepEqual(new Set(padActions(0.7, -0.7)), new Set(["up", "right"]));
  assert.deepEqual(new Set(padActions(-0.7, -0.7)), new Set(["up", "left"]));
  assert.deepEqual(new Set(padActions(-0.7, 0.7)), new Set(["down", "left"]));
  assert.deepEqual(new Set(padActions(0.7, 0.7)), new Set(["down", "right"]));
});

test("slightly beside a direction is that direction", () => {
  assert.deepEqual(padActions(0.2, -0.9), ["up"]);
  assert.deepEqual(padActions(-0.9, -0.001), ["left"]);
  assert.deepEqual(padActions(-0.9, 0.001), ["left"]);
});

test("a thumb in the pad's middle does not drive, one slid off its edge does", () => {
  assert.deepEqual(padActions(0.1, -0.2), []);
  assert.deepEqual(padActions(0, -3), ["up"]);
});
