import assert from "node:assert/strict";
import { test } from "node:test";
import { robotOf, camerasOf } from "../../../server/static/js/watch/view_choice.js";

test("the address names the robot whose camera is shown", () => {
  assert.equal(robotOf("#robot3"), 3);
  assert.equal(robotOf("#robot0"), 0);
  for (const none of ["", "#", "#robot", "#robot-1", "#robot3x", "#content", "#robot1000"]) assert.equal(robotOf(none), null, none);
});

test("each player's robot can be chosen, by its number; and the one that is chosen stays when its player goes", () => {
  const users = [{ name: "bo", robot: 4 }, { name: "al", robot: 1 }];
  assert.deepEqual(camerasOf(users, null), [{ robot: 1, name: "al" }, { robot: 4, name: "bo" }]);
  assert.deepEqual(camerasOf(users, 4), camerasOf(users, null));
  assert.deepEqual(camerasOf(users, 2)[1], { robot: 2, name: "" });
  assert.deepEqual(camerasOf([], null), []);
});
