import assert from "node:assert/strict";
import { test } from "node:test";
import { Sights } from "../../../server/static/js/game/view_choice.js";

const LOOKING = { state: "waiting", reason: "the camera is looked for" };
const AWAY = { state: "waiting", reason: "the camera is away" };
const LIVE = { state: "live", reason: "" };
const NONE = { state: "none", reason: "" };

/** Sights that have heard of these states of the camera. */
function after(states, { hasArena = true, wanted = "eyes" } = {}) {
  const sights = new Sights(hasArena, wanted);
  for (const state of states) sights.take(state);
  return sights;
}
const shown = ({ view, canSwitch, rests }) => [view, canSwitch, rests];

test("without a camera, and while nothing is known of one, the stage is as it was", () => {
  for (const states of [[], [LOOKING], [NONE], [LOOKING, NONE]]) {
    for (const hasArena of [true, false]) assert.deepEqual(shown(after(states, { hasArena })), ["arena", false, false]);
  }
});

test("it begins with the camera as soon as that is live", () => {
  assert.deepEqual(shown(after([LOOKING, LIVE])), ["eyes", true, false]);
  assert.deepEqual(shown(after([LOOKING, AWAY])), ["arena", true, false]);
  assert.deepEqual(shown(after([LOOKING, AWAY, LIVE])), ["eyes", true, false]);
});

test("a camera that falls silent stays on the stage, which tells why", () => {
  assert.deepEqual(shown(after([LIVE, AWAY])), ["eyes", true, false]);
});

test("a robot that has its camera no more is driven by the arena", () => {
  assert.deepEqual(shown(after([LIVE, NONE])), ["arena", false, false]);
});

test("who wants the arena gets it, and then the camera rests", () => {
  assert.deepEqual(shown(after([LOOKING, LIVE], { wanted: "arena" })), ["arena", true, true]);
  assert.deepEqual(shown(after([LOOKING, AWAY], { wanted: "arena" })), ["arena", true, false]);
});

test("without an arena there is only the camera, whatever is wanted", () => {
  assert.deepEqual(shown(after([LIVE], { hasArena: false, wanted: "arena" })), ["eyes", false, false]);
  assert.deepEqual(shown(after([AWAY], { hasArena: false })), ["eyes", false, false]);
});

test("one switches to the other and back", () => {
  const sights = after([LIVE]);
  assert.equal(sights.toggle(), "arena");
  assert.deepEqual(shown(sights), ["arena", true, true]);
  assert.equal(sights.toggle(), "eyes");
  assert.deepEqual(shown(sights), ["eyes", true, false]);
});

test("who asks for a camera that is away sees why", () => {
  const sights = after([AWAY]);
  assert.equal(sights.toggle(), "eyes");
  assert.deepEqual(shown(sights), ["eyes", true, false]);
});
