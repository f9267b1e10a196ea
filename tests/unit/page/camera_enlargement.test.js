import assert from "node:assert/strict";
import { test } from "node:test";
import { enlargement } from "../../../server/static/js/camera/enlargement.js";

test("a small picture on a large page is enlarged by half of what is needed at most", () => {
  assert.equal(enlargement(320, 1280), 2);
  assert.equal(enlargement(320, 1366), 2);
  assert.equal(enlargement(320, 1920), 3);
});

test("a picture that fills the page by itself, or is not shown yet, stays as it is", () => {
  assert.equal(enlargement(640, 1280), 1);
  assert.equal(enlargement(1280, 1280), 1);
  assert.equal(enlargement(320, 0), 1);
});
