import assert from "node:assert/strict";
import { test } from "node:test";
import { isValidName, tidyName } from "../../../server/static/js/common/player_name.js";

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
