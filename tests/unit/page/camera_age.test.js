import assert from "node:assert/strict";
import { afterEach, beforeEach, test } from "node:test";
import { ageOf } from "../../../server/static/js/camera/age.js";
import { cameraText, isUnknown } from "../../../server/static/js/camera/words.js";
import { speak } from "./samples.js";

beforeEach(() => speak("en"));
afterEach(() => speak("en"));

const waiting = (reason) => ({ robot: 3, state: "waiting", reason });

test("a picture's age is told when it can be noticed, and from 1 s on it is stale", () => {
  assert.deepEqual(ageOf(-0.01), { level: "fresh", text: "" });
  assert.deepEqual(ageOf(0.29), { level: "fresh", text: "" });
  assert.deepEqual(ageOf(0.44), { level: "late", text: "0.4 s old" });
  assert.deepEqual(ageOf(1), { level: "stale", text: "1 s old" });
  assert.deepEqual(ageOf(63.4), { level: "stale", text: "63 s old" });
  speak("de");
  assert.equal(ageOf(0.44).text, "0,4 s alt");
});

test("why there is no picture is told in the player's language, as far as the reason is known", () => {
  assert.equal(cameraText({ robot: 3, state: "live", reason: "" }), "");
  assert.equal(cameraText({ robot: 3, state: "none", reason: "" }), "This robot has no camera.");
  assert.equal(cameraText(waiting("no picture came for 3 s")), "The camera does not answer. The page keeps trying.");
  assert.equal(cameraText(waiting("the camera answers 404 Not Found")), "No picture from the camera: the camera answers 404 Not Found.");
  speak("it");
  assert.equal(
    cameraText({ robot: 3, state: "refused", reason: "the cameras are hidden while a battle runs" }),
    "Le telecamere sono nascoste finché dura la battaglia.",
  );
});

test("only at the very beginning it is unknown whether there is a camera", () => {
  assert.ok(isUnknown(waiting("the camera is looked for")));
  assert.ok(isUnknown(waiting("nothing has been heard from the referee yet")));
  assert.ok(!isUnknown(waiting("the camera is away")));
  assert.ok(!isUnknown({ robot: 3, state: "live", reason: "" }));
});
