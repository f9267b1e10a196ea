import assert from "node:assert/strict";
import { afterEach, test } from "node:test";
import { speak } from "./samples.js";
import { LightPlan, checkResult, checkRow, whyNoCheck } from "../../../server/static/js/desk/light_plan.js";

afterEach(() => speak("en"));

test("each robot flashes in turn and is dark before the next one does", () => {
  const plan = new LightPlan([3, 7], 1000);
  const turns = [1000, 2499, 2500, 2999, 3000, 4999, 5000].map((now) => plan.turn(now));
  assert.deepEqual(turns, [
    { robot: 3, shoot: true }, { robot: 3, shoot: true }, { robot: 3, shoot: false }, { robot: 3, shoot: false },
    { robot: 7, shoot: true }, { robot: 7, shoot: false }, null,
  ]);
});

test("coded light tells whose it is, plain light is that of the robot whose turn it is, and nobody sees itself", () => {
  const plan = new LightPlan([1, 2, 3], 0);
  plan.saw(2, 1, 100);
  plan.saw(3, 1, 2100); // late: its own code tells
  plan.saw(1, undefined, 2100);
  plan.saw(2, undefined, 2200);
  plan.saw(1, 1, 2300);
  plan.saw(1, 99, 2300); // a toy's
  plan.saw(1, undefined, 9000);
  assert.deepEqual([1, 2, 3].map((robot) => plan.seenBy(robot)), [[2, 3], [1], []]);
  assert.deepEqual([1, 2, 3].map((robot) => plan.sawOf(robot)), [[2], [1], [1]]);
});

test("the table tells what is known so far, and in the end who needs a hand", () => {
  const plan = new LightPlan([1, 2, 3], 0);
  plan.saw(2, 1, 100);
  const row = (robot, now, ended = false) => checkRow(plan, robot, now, ended);
  assert.deepEqual(row(1, 200), { seen: { text: "2" }, saw: { text: "-" } });
  assert.deepEqual(row(2, 2200).seen, { text: "flashes..." });
  assert.deepEqual(row(3, 2200), { seen: { text: "-" }, saw: { text: "-" } });
  assert.deepEqual(row(2, 2200, true).seen, { text: "-" });
  plan.saw(1, 2, 2300);
  assert.deepEqual(row(3, 6000), { seen: { text: "nobody", level: "bad" }, saw: { text: "none", level: "bad" } });
  assert.deepEqual(row(2, 6000), { seen: { text: "1" }, saw: { text: "1" } });
  assert.match(checkResult(plan), /robot 3:/);
  plan.saw(3, 2, 6000);
  plan.saw(2, 3, 6000);
  assert.equal(checkResult(plan), "All robots flash and see.");
});

test("a light check would count the shots of players who practise", () => {
  const robots = [{ linked: true, player: null }, { linked: true, player: "Ann" }, { linked: false, player: "Bob" }];
  assert.match(whyNoCheck({ state: "stopped" }, robots, true), /^Players could shoot/);
  assert.equal(whyNoCheck({ state: "stopped" }, robots, false), "");
  assert.equal(whyNoCheck({ state: "stopped" }, [robots[0], robots[0], robots[2]], true), "");
});

test("a light check takes two robots and no battle", () => {
  const robots = [true, false, true].map((linked) => ({ linked, player: null }));
  assert.equal(whyNoCheck({ state: "stopped" }, robots, true), "");
  assert.match(whyNoCheck({ state: "stopped" }, robots.slice(0, 2), true), /there are 1/);
  for (const state of ["countdown", "playing"]) assert.match(whyNoCheck({ state }, robots, true), /Only while/);
});
