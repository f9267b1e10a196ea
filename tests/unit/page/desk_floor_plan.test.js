import assert from "node:assert/strict";
import { test } from "node:test";
import {
  added, dragged, fieldsOf, handlesOf, headingOf, History, isPlaced, keyOf, moved, nudged, readPlan, removed, thingsOf, toFile, withField,
} from "../../../server/static/js/desk/floor_plan.js";

const HILL = { name: "hill 1", kind: "hill", x: 2, y: 1, radius: 0.3 };
const PLAN = readPlan({ width: 4, height: 2, walls: [[1, 0.5, 1, 1.5]], starts: [[0.5, 1], [3, 1, 1.5]], zones: [HILL] });
const WALL = { list: "walls", index: 0 };
const START = { list: "starts", index: 0 };
const ZONE = { list: "zones", index: 0 };

test("a floor without walls and zones has none", () => {
  assert.deepEqual(readPlan({ width: 1, height: 1, starts: [[0.5, 0.5]] }).walls, []);
  assert.deepEqual(thingsOf(PLAN).map(keyOf), ["walls[0]", "starts[0]", "starts[1]", "zones[0]"]);
});

test("what is moved keeps to the grid and stays on the floor as it is", () => {
  assert.deepEqual(moved(PLAN, WALL, 0.1234, 0.2).walls[0], [1.12, 0.7, 1.12, 1.7]);
  assert.deepEqual(moved(PLAN, WALL, -9, 9).walls[0], [0, 1, 0, 2]);
  assert.deepEqual(moved(PLAN, START, 0.1, 0).starts, [[0.6, 1], [3, 1, 1.5]]);
  assert.deepEqual(moved(PLAN, ZONE, 9, 0.5).zones[0], { ...HILL, x: 4, y: 1.5 });
  assert.deepEqual(PLAN.walls[0], [1, 0.5, 1, 1.5]);
});

test("handles change an end, a radius, a direction", () => {
  assert.deepEqual(dragged(PLAN, WALL, "end1", { x: 1.502, y: -3 }).walls[0], [1.5, 0, 1, 1.5]);
  assert.deepEqual(dragged(PLAN, WALL, "end2", { x: 2, y: 2 }).walls[0], [1, 0.5, 2, 2]);
  assert.equal(dragged(PLAN, ZONE, "rim", { x: 2, y: 1.4 }).zones[0].radius, 0.4);
  assert.equal(dragged(PLAN, ZONE, "rim", { x: 2, y: 1 }).zones[0].radius, 0.05);
  assert.deepEqual(dragged(PLAN, START, "nose", { x: 0.52, y: 1.9 }).starts[0], [0.5, 1, 1.5708]);
  assert.deepEqual(handlesOf(PLAN, ZONE), [{ name: "rim", x: 2.3, y: 1 }]);
  assert.deepEqual(handlesOf(PLAN, START), [{ name: "nose", x: 0.66, y: 1 }]);
});

test("the keyboard does what the mouse does", () => {
  assert.deepEqual(nudged(PLAN, WALL, "end2", 0, 0.1).walls[0], [1, 0.5, 1, 1.6]);
  assert.equal(nudged(PLAN, ZONE, "rim", -0.1, 0).zones[0].radius, 0.2);
  assert.equal(nudged(PLAN, START, "nose", -0.01, 0).starts[0][2], 0.0873, "left turns left, by 5 degrees");
});

test("a robot without a direction looks at the middle", () => {
  assert.equal(headingOf(PLAN, [2, 0]), Math.PI / 2);
  assert.equal(headingOf(PLAN, [2, 0, 1]), 1);
  assert.deepEqual(withField(PLAN, { list: "starts", index: 1 }, "heading", NaN).starts[1], [3, 1]);
  assert.deepEqual(withField(PLAN, START, "heading", 90).starts[0], [0.5, 1, 1.5708]);
});

test("fields are those of the file, in metres and degrees; an empty one is nothing to be drawn", () => {
  assert.deepEqual(fieldsOf(PLAN, WALL).map(({ name, value }) => [name, value]), [["x1", 1], ["y1", 0.5], ["x2", 1], ["y2", 1.5]]);
  assert.equal(fieldsOf(PLAN, { list: "starts", index: 1 })[2].value, 85.9);
  assert.deepEqual(withField(PLAN, WALL, "y2", 1.7).walls[0], [1, 0.5, 1, 1.7]);
  assert.equal(withField(PLAN, ZONE, "name", "top").zones[0].name, "top");
  const empty = withField(PLAN, ZONE, "x", NaN);
  assert.equal(isPlaced(empty, ZONE), false);
  assert.ok(Number.isNaN(fieldsOf(empty, ZONE)[1].value));
});

test("new things are in the middle, with a name of their own", () => {
  const [plan, thing] = added(PLAN, "hill");
  assert.deepEqual(thing, { list: "zones", index: 1 });
  assert.deepEqual([plan.zones[1].name, plan.zones[1].x, plan.zones[1].y], ["hill 2", 2, 1]);
  assert.deepEqual(added(PLAN, "wall")[0].walls[1], [2, 0.7, 2, 1.3]);
  assert.deepEqual(added(PLAN, "start")[0].starts[2], [2, 1, 0]);
  assert.deepEqual(removed(PLAN, START).starts, [[3, 1, 1.5]]);
});

test("undo takes back a whole drag, and what is saved is no change", () => {
  const history = new History(PLAN);
  assert.deepEqual([history.canUndo, history.isChanged], [false, false]);
  const places = [1, 2, 3].map((n) => moved(PLAN, WALL, n / 10, 0));
  history.change(places[0], "drag 1");
  history.change(places[1], "drag 1");
  history.change(places[2], "drag 2");
  history.undo();
  assert.equal(history.plan, places[1]);
  history.save(places[1]);
  assert.equal(history.isChanged, false);
  history.undo();
  assert.deepEqual([history.plan, history.isChanged, history.canUndo], [PLAN, true, false]);
  history.undo();
  assert.equal(history.plan, PLAN);
});

test("the file that is downloaded is the plan", () => {
  assert.deepEqual(JSON.parse(toFile(PLAN)), PLAN);
  assert.match(toFile({ ...PLAN, walls: [] }), /^ {2}"walls": \[\],$/m);
});
