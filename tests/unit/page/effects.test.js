import assert from "node:assert/strict";
import { test } from "node:test";
import { effectsText } from "../../../server/static/js/battle/effects.js";
import { player, status } from "./samples.js";

const text = (me) => effectsText(status({ users: [player("Ann", me)] }).users[0]);

test("others read what a player has picked up and who is stopped at the edge", () => {
  assert.deepEqual([0, 1, 2, 3].map((effects) => text({ effects })), ["", "shield", "double damage", "shield, double damage"]);
  assert.deepEqual([1, 2, 3].map((fence) => text({ fence })), Array(3).fill("stopped at the edge"));
  assert.equal(text({ effects: 1, life: 0 }), "", "who is out has nothing of it");
});
