import assert from "node:assert/strict";
import { test } from "node:test";
import { isValidName, loginDialog } from "../../../server/static/js/login.js";

test("names are 1 to 16 letters, digits and underscores", () => {
  for (const name of ["a", "Ann_7", "_", "0123456789abcdef"]) assert.ok(isValidName(name), name);
  for (const name of ["", "0123456789abcdefg", "a b", "<b>", "[", "^", "`", "\\", "é", "a\n"]) {
    assert.ok(!isValidName(name), JSON.stringify(name));
  }
});

test("each refusal says what to do and about whom", () => {
  assert.equal(loginDialog({ status: "BAD_NAME" }).kind, "warning");
  assert.equal(loginDialog({ status: "NO_ROBOTS", user: "al" }).kind, "warning");
  const taken = loginDialog({ status: "UNAVAILABLE", user: "al" });
  assert.equal(taken.kind, "info");
  assert.match(taken.text, /al/);
  const gone = loginDialog({ status: "ROBOT_UNAVAILABLE", robot: 3 });
  assert.equal(gone.kind, "error");
  assert.match(gone.text, /Robot 3/);
});

test("an unknown answer is shown as it is, the server's own words first", () => {
  assert.equal(loginDialog({ status: "HTTP 502", body: "bad gateway" }).text, "bad gateway");
  assert.equal(loginDialog({ status: "ERROR", error: "no such avatar", body: "{}" }).text, "no such avatar");
});
