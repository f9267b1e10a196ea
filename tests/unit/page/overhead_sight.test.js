import assert from "node:assert/strict";
import { test } from "node:test";
import { flatten, rectify } from "../../../server/static/js/overhead/rectify.js";
import { NOTHING, pixelAt, readSight } from "../../../server/static/js/overhead/sight.js";

// 2 m above the middle of a floor of 4 m x 2 m, straight down: a pixel is a cm
const view = (values = {}) => ({
  width: 400, height: 200, homography: [0.5, 0, -1, 0, -0.5, 0.5, 0, 0, 1], bend: 0, camera: [2, 1, 2], tag_height: 0.5, ...values,
});
const place = (index) => (index === NOTHING ? null : [index % 400, Math.floor(index / 400)]);
const seen = (x, y, height = 0, values = {}) => place(pixelAt(readSight(view(values)), height)(x, y));

test("a place on the floor is at its pixel, y up", () => {
  assert.deepEqual(seen(0.005, 1.995), [0, 0]);
  assert.deepEqual(seen(3.995, 0.005), [399, 199]);
  assert.deepEqual(seen(2.005, 0.995), [200, 100]);
  assert.deepEqual([seen(-0.005, 1), seen(4.005, 1), seen(2, 2.005), seen(2, -0.005)], [null, null, null, null]);
});

test("what is higher seems farther from below the camera", () => {
  assert.deepEqual(seen(2.5025, 0.9975, 1), [300, 100]);
  assert.deepEqual(seen(1.4975, 0.9975, 1), [99, 100]);
});

test("a camera that looks aslant sees what is far off smaller", () => {
  const homography = [0.5, 0, -1, 0, -0.5, 0.5, 0, 0.25, 0.75]; // as before for y = 1
  assert.deepEqual(seen(3.0025, 1, 0, { homography }), [300, 100]);
  assert.deepEqual(seen(3.0025, 1.8, 0, { homography }), [283, 33]);
});

test("a lens bends what is far from the middle towards it, and shows nothing twice", () => {
  assert.deepEqual(seen(3.9975, 1, 0, { bend: -0.2 }), [359, 100]);
  assert.equal(seen(4.8, 1, 0, { bend: -0.2 }), null); // by the formula alone, that would be at 378
  assert.equal(seen(9, 1, 0, { bend: 0.2 }), null);
});

test("a sight that is none is not used", () => {
  assert.equal(readSight(view()).tagHeight, 0.5);
  for (const values of [
    { width: 0 }, { height: 0 }, { width: 65535, height: 65535 }, { homography: [1, 2] }, { camera: [] }, { bend: null },
    { camera: [2, 1, 0.5] }, { tag_height: null }, { homography: [null, 0, -1, 0, -0.5, 0.5, 0, 0, 1] },
  ]) assert.equal(readSight(view(values)), null, JSON.stringify(values));
});

test("the flat picture has 960 pixels on its longer side, and is filled from the camera's", () => {
  const wide = flatten(readSight(view()), { left: 0, bottom: 0, right: 4, top: 2 }, 0);
  assert.deepEqual([wide.width, wide.height, wide.from.length], [960, 480, 960 * 480]);
  const tall = flatten(readSight(view()), { left: 1, bottom: 0, right: 2, top: 2 }, 0);
  assert.deepEqual([tall.width, tall.height], [480, 960]);
  const picture = Uint32Array.from({ length: 400 * 200 }, (_, n) => 7 + n);
  const pixels = new Uint32Array(480 * 960).fill(1);
  rectify(picture, tall, pixels);
  assert.deepEqual([pixels[0], pixels.at(-1)], [picture[100], picture[199 * 400 + 199]]);
});

test("around what the camera sees, the flat picture is transparent", () => {
  const flat = flatten(readSight(view()), { left: -4, bottom: 0, right: 4, top: 2 }, 0);
  const pixels = new Uint32Array(flat.from.length).fill(1);
  rectify(new Uint32Array(400 * 200).fill(0xff0000ff), flat, pixels);
  assert.deepEqual([pixels[0], pixels[479], pixels[480], pixels[959]], [0, 0, 0xff0000ff, 0xff0000ff]);
});
