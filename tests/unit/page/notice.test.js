import assert from "node:assert/strict";
import { afterEach, test } from "node:test";
import { noticeText } from "../../../server/static/js/common/notice.js";
import { speak } from "./samples.js";

afterEach(() => speak("en"));

const NOTICES = [
  ...["Bob is no longer ready", "Bob lost the robot", "Bob signed out", "Bob left the page", "Bob was signed out by the operator"].map(
    (cause) => `Countdown stopped: ${cause}, fewer than two players are ready.`,
  ),
  "Countdown stopped: the operator has ended it.",
  ...["Bob was shot down", "the time limit is reached", "the operator has ended it"].map((cause) => `Battle over: ${cause}.`),
];

test("in English a notice stays as the server says it", () => {
  for (const notice of NOTICES) assert.equal(noticeText(notice), notice);
});

test("in other languages none of it stays English, but the name", () => {
  for (const language of ["it", "de"]) {
    speak(language);
    for (const notice of NOTICES) {
      const text = noticeText(notice);
      assert.doesNotMatch(text, /stopped|over|ready|page|lost|operator\b|limit|shot/, text);
      assert.equal(text.includes("Bob"), notice.includes("Bob"), text);
    }
  }
});

test("what the page does not know is shown as it is", () => {
  speak("de");
  assert.equal(noticeText("Something new."), "Something new.");
  assert.equal(noticeText(""), "");
});

test("a name may have spaces and words of the sentence", () => {
  speak("de");
  for (const name of ["Bo Lee", "lost the robot"]) {
    assert.equal(noticeText(`Battle over: ${name} signed out.`), noticeText("Battle over: X signed out.").replace("X", name));
  }
});
