import assert from "node:assert/strict";
import { test } from "node:test";
import { leading } from "../../../server/static/js/common/audience.js";
import { presetName } from "../../../server/static/js/common/preset_names.js";
import { speak } from "./samples.js";

const vote = (...votes) => ({ number: 1, seconds_left: 0, choices: votes.map((count, index) => ({ name: `P${index}`, own: true, votes: count })) });
const ahead = (...votes) => leading(vote(...votes)).map(({ name }) => name);

test("whoever has most votes is ahead, and all who have as many", () => {
  assert.deepEqual(ahead(1, 3, 2), ["P1"]);
  assert.deepEqual(ahead(3, 3, 2), ["P0", "P1"]);
});

test("without any vote, nobody is ahead", () => {
  assert.deepEqual(ahead(0, 0), []);
});

test("an operator's preset has the name that it was given, the others have one in each language", () => {
  assert.equal(presetName({ name: "short_rounds", own: true }), "short_rounds");
  for (const language of ["en", "it", "de"]) {
    speak(language);
    assert.match(presetName({ name: "short_rounds", own: false }), /^[A-Z]/);
  }
});
