import assert from "node:assert/strict";
import { test } from "node:test";
import { loginDialog } from "../../../server/static/js/lobby/login.js";
import "./samples.js";

test("each refusal says what to do and about whom", () => {
  const taken = loginDialog({ status: "UNAVAILABLE", user: "al" });
  assert.equal(taken.kind, "info");
  assert.match(taken.text, /al/);
  assert.match(loginDialog({ status: "ROBOT_UNAVAILABLE", robot: 3 }).title, /Robot 3 is not free/);
});

test("an unknown answer is shown as it is, the server's own words first", () => {
  assert.equal(loginDialog({ status: "HTTP 502", body: "bad gateway" }).text, "bad gateway");
  assert.equal(loginDialog({ status: "ERROR", error: "no such avatar", body: "{}" }).text, "no such avatar");
  const early = loginDialog({ status: "ERROR", error: "too many sign-ups from your address: again in 3 s" });
  assert.match(early.title, /That does not work/);
  assert.match(early.text, /again in 3 s/);
});
