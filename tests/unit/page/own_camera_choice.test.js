import assert from "node:assert/strict";
import { test } from "node:test";
import { ViewChoice } from "../../../server/static/js/game/view_choice.js";

const LOOKING = { state: "waiting", reason: "the camera is looked for" };
const AWAY = { state: "waiting", reason: "the camera is away" };
const LIVE = { state: "live", reason: "" };
const NONE = { state: "none", reason: "" };

/** ViewChoice that have heard of these states of the camera. */
function after(states, { hasArena = true, wanted = "camera" } = {}) {
  const choice = new ViewChoice(wanted);
  choice.takeArena(hasArena);
  for (const state of states) choice.take(state);
  return choice;
}
const shown = ({ view, canSwitch, rests }) => [view, canSwitch, rests];

test("without a camera, and while nothing is known of one, the stage is as it was", () => {
  for (const states of [[], [LOOKING], [NONE], [LOOKING, NONE]]) {
    for (const hasArena of [true, false]) assert.deepEqual(shown(after(states, { hasArena })), ["arena", false, false]);
  }
});

test("it begins with the camera as soon as that is live", () => {
  assert.deepEqual(shown(after([LOOKING, LIVE])), ["camera", true, false]);
  assert.deepEqual(shown(after([LOOKING, AWAY])), ["arena", true, false]);
  assert.deepEqual(shown(after([LOOKING, AWAY, LIVE])), ["camera", true, false]);
});

test("a camera that falls silent stays on the stage, which tells why", () => {
  assert.deepEqual(shown(after([LIVE, AWAY])), ["camera", true, false]);
});

test("a robot that has its camera no more is driven by the arena", () => {
  assert.deepEqual(shown(after([LIVE, NONE])), ["arena", false, false]);
});

test("who wants the arena gets it, and then the camera rests", () => {
  assert.deepEqual(shown(after([LOOKING, LIVE], { wanted: "arena" })), ["arena", true, true]);
  assert.deepEqual(shown(after([LOOKING, AWAY], { wanted: "arena" })), ["arena", true, false]);
});

test("without an arena there is only the camera, whatever is wanted", () => {
  assert.deepEqual(shown(after([LIVE], { hasArena: false, wanted: "arena" })), ["camera", false, false]);
  assert.deepEqual(shown(after([AWAY], { hasArena: false })), ["camera", false, false]);
});

test("while it is not known whether there is an arena, nothing can be chosen, and what was wanted is shown", () => {
  for (const [wanted, view] of [["arena", "arena"], ["camera", "camera"]]) {
    const choice = new ViewChoice(wanted);
    choice.take(LIVE);
    assert.deepEqual([choice.view, choice.canSwitch], [view, false]);
  }
});

test("one switches to the other and back", () => {
  const choice = after([LIVE]);
  assert.equal(choice.toggle(), "arena");
  assert.deepEqual(shown(choice), ["arena", true, true]);
  assert.equal(choice.toggle(), "camera");
  assert.deepEqual(shown(choice), ["camera", true, false]);
});

test("who asks for a camera that is away sees why", () => {
  const choice = after([AWAY]);
  assert.equal(choice.toggle(), "camera");
  assert.deepEqual(shown(choice), ["camera", true, false]);
});
