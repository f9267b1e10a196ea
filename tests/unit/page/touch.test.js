import assert from "node:assert/strict";
import { test } from "node:test";
import { stickAt } from "../../../server/static/js/drive/touch.js";

const RADIUS = 60;
const CENTRE = { x: 100, y: 200 };
const at = (x, y, centre = CENTRE) => stickAt(centre, { x: centre.x + x, y: centre.y + y }, RADIUS);

test("a thumb that has just come down does not drive", () => {
  assert.deepEqual(at(0, 0), { centre: CENTRE, knob: { x: 0, y: 0 }, actions: [] });
  assert.deepEqual(at(10, -8).actions, []);
});

test("a thumb moved away from where it came down drives in eight directions", () => {
  const directions = [
    [0, -40, ["up"]], [0, 40, ["down"]], [-40, 0, ["left"]], [40, 0, ["right"]],
    [30, -30, ["up", "right"]], [-30, -30, ["left", "up"]], [-30, 30, ["down", "left"]], [30, 30, ["right", "down"]],
  ];
  for (const [x, y, actions] of directions) {
    assert.deepEqual(at(x, y).actions, actions);
    assert.deepEqual(at(x, y).centre, CENTRE);
  }
});

test("the knob stays on the stick, and a thumb beyond it draws the stick along", () => {
  const { centre, knob, actions } = at(0, -100);
  assert.deepEqual(knob, { x: 0, y: -RADIUS });
  assert.deepEqual(centre, { x: 100, y: 160 });
  assert.deepEqual(actions, ["up"]);
});

test("to turn back counts at once, however far the thumb has gone", () => {
  const far = at(0, -300);
  const back = stickAt(far.centre, { x: 100, y: -100 + RADIUS + 20 }, RADIUS);
  assert.deepEqual(back.actions, ["down"]);
});
