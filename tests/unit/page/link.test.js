import assert from "node:assert/strict";
import { test } from "node:test";
import { LinkQuality } from "../../../server/static/js/game/link.js";

const measured = (...times) => {
  const quality = new LinkQuality();
  for (const ms of times) quality.add(ms);
  return quality.value;
};

test("the link's quality goes by the middle of the last times", () => {
  assert.equal(measured(), null);
  assert.deepEqual(measured(12.4), { ms: 12, level: "good" });
  assert.deepEqual(measured(10, 11, 900, 12, 13), { ms: 12, level: "good" }, "one late answer does not alarm");
  assert.deepEqual(measured(10, 10, 10, 150, 150, 150), { ms: 150, level: "fair" });
  assert.equal(measured(250, 300).level, "poor");
});

test("a new connection is measured anew", () => {
  const quality = new LinkQuality();
  quality.add(500);
  quality.clear();
  assert.equal(quality.value, null);
});
