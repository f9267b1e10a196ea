import assert from "node:assert/strict";
import { test } from "node:test";
import "./samples.js";

// the module names its columns as it is loaded, in the page's language
const { trouble } = await import("../../../server/static/js/desk/bots.js");

test("the desk says why robots that are for bots stand still, and nothing where none is", () => {
  const robots = [{ bot: null }, { bot: "easy" }];
  assert.equal(trouble(robots, "ready"), "");
  assert.match(trouble(robots, "absent"), /program is not running/);
  assert.match(trouble(robots, "blind"), /camera above the floor/);
  assert.equal(trouble([{ bot: null }], "absent"), "");
});
