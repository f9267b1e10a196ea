import assert from "node:assert/strict";
import { test } from "node:test";
import { isValidName, loginDialog, tidyName } from "../../../server/static/js/lobby/login.js";
import "./samples.js";

test("names are 1 to 16 letters, digits, underscores and single spaces between them", () => {
  for (const name of ["a", "Ann_7", "_", "0123456789abcdef", "Jörg", "日本", "हिन्दी", "Ann Lee", "a b c"]) assert.ok(isValidName(name), name);
  for (const name of ["", "0123456789abcdefg", "01234567 89abcdef", "a  b", " a", "a ", "a \u0301b", "<b>", "[", "^", "`", "\\", "a\n", "\u0301a", "a\u200db", "😀", "a\u3164", "operator\ufe0f"]) {
    assert.ok(!isValidName(name), JSON.stringify(name));
  }
});

test("spaces too many are taken away", () => {
  assert.equal(tidyName("  Ann \t Lee "), "Ann Lee");
  assert.equal(tidyName("e\u0301"), "é");
});

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
