import assert from "node:assert/strict";
import { test } from "node:test";
import { podium } from "../../../server/static/js/results/podium.js";
import { player } from "./samples.js";

/** The result of players with these places; a place with a minus has left early. */
const result = (...places) => places.map((place, index) => player(`P${index}`, { place: Math.abs(place), left: place < 0 }));

/** {metal: names}, and the names of the rest. */
function told(entries) {
  const { steps, rest } = podium(entries);
  const names = (players) => players.map((one) => one.name).join(" ");
  return [Object.fromEntries(steps.map((step) => [step.metal, names(step.players)])), names(rest)];
}

test("the first three stand on their steps, the others below", () => {
  assert.deepEqual(told(result(1, 2, 3, 4, 5)), [{ gold: "P0", silver: "P1", bronze: "P2" }, "P3 P4"]);
});

test("two players fill two steps", () => {
  assert.deepEqual(told(result(1, 2)), [{ gold: "P0", silver: "P1" }, ""]);
});

test("ties share a step, and the step after them stays empty", () => {
  assert.deepEqual(told(result(1, 1, 3)), [{ gold: "P0 P1", bronze: "P2" }, ""]);
  assert.deepEqual(told(result(1, 2, 2, 4)), [{ gold: "P0", silver: "P1 P2" }, "P3"]);
  assert.deepEqual(told(result(1, 1, 1, 1)), [{ gold: "P0 P1 P2 P3" }, ""]);
});

test("who left early stands on no step, but is told", () => {
  assert.deepEqual(told(result(1, -2)), [{ gold: "P0" }, "P1"]);
});

test("without a result there is nothing to stand on", () => {
  assert.deepEqual(told([]), [{}, ""]);
});

test("teams stand on the steps as one, and the next team is on the next step", () => {
  const teams = [1, 1, 1, 4, 4, 6].map((place, index) => player(`P${index}`, { place, team: [2, 2, 2, 1, 1, 3][index] }));
  assert.deepEqual(told(teams), [{ gold: "P0 P1 P2", silver: "P3 P4", bronze: "P5" }, ""]);
});
