import assert from "node:assert/strict";
import { test } from "node:test";
import { ClockOffset } from "../../../server/static/js/camera/clock.js";
import { pictureOf } from "../../../server/static/js/camera/picture.js";
import { picture } from "./samples.js";

test("a picture tells its robot, its number, when it was taken and sent, and the JPEG", () => {
  const told = pictureOf(picture({ robot: 7, number: 4_000_000_000, taken: 1795545856.456, sent: 1795545856.5, jpeg: [255, 216, 255, 217] }));
  assert.deepEqual({ ...told, jpeg: [...told.jpeg] }, {
    robot: 7, number: 4_000_000_000, taken: 1795545856.456, sent: 1795545856.5, jpeg: [255, 216, 255, 217],
  });
});

test("the bytes are those of docs/protocol-camera.md", () => {
  const bytes = [...new Uint8Array(picture({ robot: 3, number: 258, taken: 1.5, sent: 2, jpeg: [9] }))];
  assert.deepEqual(bytes, [3, 0, 0, 0, 2, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0xf8, 0x3f, 0, 0, 0, 0, 0, 0, 0, 0x40, 9]);
});

test("what is too short for a picture, or tells no time, is none", () => {
  assert.equal(pictureOf(new ArrayBuffer(0)), null);
  assert.equal(pictureOf(picture({ jpeg: [] })), null);
  assert.equal(pictureOf(picture({ taken: NaN })), null);
  assert.equal(pictureOf(picture({ sent: Infinity })), null);
});

test("the picture that was on the way for the shortest time tells how far the clocks are apart", () => {
  const clock = new ClockOffset();
  assert.equal(clock.sample(1000, 5.5), -994.5);
  assert.equal(clock.sample(1001, 6.25), -994.75);
  assert.equal(clock.sample(1002, 8), -994.75); // it came late
});

test("an old sample is forgotten, as clocks drift", () => {
  const clock = new ClockOffset();
  clock.sample(1000, 0);
  for (let at = 1; at < 60; at += 1) assert.equal(clock.sample(1000 + at, at + 0.5), -1000);
  assert.equal(clock.sample(1060, 60.5), -999.5);
});

test("a clock that was set counts at once", () => {
  const clock = new ClockOffset();
  clock.sample(1000, 0);
  assert.equal(clock.sample(400, 1), -399);
});
