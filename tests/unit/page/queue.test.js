import assert from "node:assert/strict";
import { test } from "node:test";
import { battleText, queueText, waitText } from "../../../server/static/js/battle/queue.js";
import { player, status } from "./samples.js";

test("who waits learns the place and about how long it takes", () => {
  assert.match(queueText({ place: 1, offer: null, seconds: 100 }).title, /next/);
  const third = queueText({ place: 3, offer: null, seconds: 400 });
  assert.match(third.title, /number 3/);
  assert.match(third.text, /7 minutes/);
});

test("an offer names the robot, the first too, and the time to take it", () => {
  const offer = queueText({ place: 1, offer: 0, seconds: 17 });
  assert.match(offer.title, /Robot 0/);
  assert.match(offer.text, /17 s/);
  assert.equal(offer.tab, "(17 s) Robot 0 is yours!");
});

test("times are said as people say them", () => {
  assert.deepEqual([5, 59, 89, 91, 600].map(waitText), ["a minute", "one minute", "one minute", "2 minutes", "10 minutes"]);
});

test("who waits reads who is in the battle", () => {
  const users = [player("Ann", { ready: true }), player("Bob", { ready: true, life: 0 }), player("Cy", { ready: true }), player("Dee")];
  assert.equal(battleText(status({ game: 2, users })), "In the battle: Ann and Cy");
  assert.equal(battleText(status({ game: 0, users })), "");
});
