import assert from "node:assert/strict";
import { test } from "node:test";
import { knownName } from "../../../server/static/js/common/known_name.js";

test("a visitor whom nobody has sent has no name here", () => {
  for (const cookies of ["", "laserbot_language=de", "laserbot_play=1", "laserbot_name=", "laserbot_name=Ann", "laserbot_name=2.", "laserbot_name=2.%E0%A4%A"]) {
    assert.equal(knownName(cookies), null, cookies);
  }
});

test("the name comes with its avatar, in any script", () => {
  assert.deepEqual(knownName("laserbot_theme=dark; laserbot_name=3.J%C3%B6rg%20Lee"), { name: "Jörg Lee", avatar: 3, plays: false });
});

test("only whom the entrance has just sent plays at once", () => {
  assert.equal(knownName("laserbot_play=1; laserbot_name=0.Ann").plays, true);
  assert.equal(knownName("laserbot_play=; laserbot_name=0.Ann").plays, false);
  assert.equal(knownName("xlaserbot_play=1; laserbot_name=0.Ann").plays, false);
});
