import assert from "node:assert/strict";
import { test } from "node:test";
import { layOut } from "../../../server/static/js/arena/labels.js";

const RADIUS = 20;
const tag = (x, y, values = {}) => ({ x, y, radius: RADIUS, width: 90, height: 25, ...values });

/** The same numbers at every run, 0 to 1. */
function numbers(seed) {
  let state = seed;
  return () => (state = (state * 48271) % 2147483647) / 2147483647;
}

/** Which part of the smaller label two labels share. */
function shared([a, one], [b, other]) {
  const x = Math.min(a.left + one.width, b.left + other.width) - Math.max(a.left, b.left);
  const y = Math.min(a.top + one.height, b.top + other.height) - Math.max(a.top, b.top);
  return x > 0 && y > 0 ? (x * y) / Math.min(one.width * one.height, other.width * other.height) : 0;
}

test("a label stands centred above its robot, below it at the upper edge", () => {
  assert.deepEqual(layOut([tag(200, 150)], 400, 300), [{ left: 155, top: 105 }]);
  assert.deepEqual(layOut([tag(200, 30)], 400, 300), [{ left: 155, top: 50 }]);
});

test("labels that are far from each other do not move", () => {
  const tags = [tag(100, 100), tag(300, 100), tag(100, 250)];
  assert.deepEqual(layOut(tags, 400, 300), tags.map((each) => layOut([each], 400, 300)[0]));
});

test("two robots side by side have two labels that can be read, and neither covers a robot", () => {
  const tags = [tag(180, 150), tag(220, 150)];
  const places = layOut(tags, 400, 300);
  assert.equal(shared([places[0], tags[0]], [places[1], tags[1]]), 0);
  for (const { top } of places) assert.ok(top + 25 <= 151 - 0.7 * RADIUS || top >= 149 + 0.7 * RADIUS);
});

test("in any crowd on a phone all labels are inside and no two share more than a third", () => {
  const random = numbers(7);
  const [width, height] = [390, 298];
  for (let crowd = 0; crowd < 400; crowd++) {
    const spread = 0.15 + 0.85 * random(); // from a heap to the whole floor
    const [x, y] = [random() * (1 - spread) * width, random() * (1 - spread) * height];
    const tags = Array.from({ length: 8 }, () =>
      tag(x + random() * spread * width, y + random() * spread * height, { radius: 17, width: 60 + 50 * random() }),
    );
    const places = layOut(tags, width, height);
    places.forEach(({ left, top }, n) => {
      assert.ok(left >= -1e-6 && top >= -1e-6 && left + tags[n].width <= width + 1e-6 && top + tags[n].height <= height + 1e-6);
    });
    for (let a = 0; a < 8; a++) {
      for (let b = 0; b < a; b++) {
        const part = shared([places[a], tags[a]], [places[b], tags[b]]);
        assert.ok(part < 1 / 3, `crowd ${crowd}: ${part.toFixed(2)}`);
      }
    }
  }
});

test("robots on the very same spot, and no robots", () => {
  const tags = [tag(200, 150), tag(200, 150), tag(200, 150)];
  const tops = layOut(tags, 400, 300).map(({ top }) => Math.round(top));
  assert.equal(new Set(tops).size, 3);
  assert.deepEqual(layOut([], 400, 300), []);
});
