import assert from "node:assert/strict";
import { afterEach, test } from "node:test";
import { noticeText } from "../../../server/static/js/common/notice.js";
import { speak } from "./samples.js";

afterEach(() => speak("en"));

const LOST_SEATS = [
  "Bob makes room for a person", "Bob makes room for a match of the tournament", "Bob signed up again as Bobby",
  "Bob has a robot that is out of service",
  "Bob did not take the robot in time", "Bob was not ready for 60 s while others waited",
  "Bob has played 3 in a row, and others wait", "Bob has had the robot for 2.5 min, and others wait",
  "Bob has one of several robots at one address, and others wait",
];

const NOTICES = [
  ...LOST_SEATS.map((cause) => `Countdown stopped: ${cause}, fewer than two players are ready.`),
  ...["Bob is no longer ready", "Bob lost the robot", "Bob signed out", "Bob left the page", "Bob was signed out by the operator"].map(
    (cause) => `Countdown stopped: ${cause}, fewer than two players are ready.`,
  ),
  "Countdown stopped: the operator has ended it.",
  ...["robot 3 is about to restart", "the server is about to restart"].map((cause) => `The next battle waits: ${cause}.`),
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
      assert.doesNotMatch(text, /stopped|over|ready|page|lost|operator\b|limit|shot|makes|again|take|others|wait|several|robot that|about|next/, text);
      assert.equal(text.includes("Bob"), notice.includes("Bob"), text);
    }
  }
});

test("other languages keep the figures and the new name of a lost seat", () => {
  speak("de");
  const told = (cause) => noticeText(`Countdown stopped: ${cause}, fewer than two players are ready.`);
  assert.match(told("Bob was not ready for 60 s while others waited"), /Bob.* 60 s/);
  assert.match(told("Bob has played 3 in a row, and others wait"), /Bob.* 3/);
  assert.match(told("Bob has had the robot for 2.5 min, and others wait"), /Bob.* 2,5 min/);
  assert.match(told("Bob signed up again as Bobby"), /Bob .*Bobby/);
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
