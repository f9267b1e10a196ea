import assert from "node:assert/strict";
import { test } from "node:test";
import { FirstSteps, hintText } from "../../../server/static/js/game/first_steps.js";
import { player, speak, status } from "./samples.js";

const me = player("ann", { ready: true });
const lobby = status({ users: [player("ann")], practice: true });
const battle = (number) => status({ game: 2, battle: number, users: [me] });
const over = (number) => status({ battle: number, users: [player("ann")], result: [player("ann", { place: 1 })] });

/** What is on the page after these states. */
function stepsAfter(...states) {
  const steps = new FirstSteps();
  states.reduce((previous, current) => (steps.take(previous, current, "ann"), current), null);
  return steps;
}

test("one hint follows the other as each is done, in whatever order", () => {
  const steps = stepsAfter(lobby);
  assert.deepEqual(steps.hint, { step: "drive", n: 1, all: 3 });
  steps.act(["left"]);
  assert.equal(steps.hint.step, "drive");
  steps.act(["down"]);
  assert.deepEqual(steps.hint, { step: "shoot", n: 3, all: 3 });
  steps.act([]);
  assert.ok(!steps.isDone);
  steps.act(["up", "shoot"]);
  assert.equal(steps.hint, null);
  assert.ok(steps.isDone);
});

test("they may be skipped", () => {
  const steps = stepsAfter(lobby);
  steps.skip();
  assert.ok(steps.isDone);
});

test("a first battle has them, and whoever has fought in one knows", () => {
  assert.equal(stepsAfter(lobby, battle(1)).hint.step, "drive");
  assert.ok(stepsAfter(lobby, battle(1), over(1)).isDone);
});

test("a page that is opened in the middle of its player's battle gives none in it", () => {
  assert.equal(stepsAfter(battle(1)).hint, null);
  assert.equal(stepsAfter(battle(1), battle(1)).hint, null);
  assert.equal(stepsAfter(battle(1), lobby).hint.step, "drive");
  const beside = status({ game: 2, battle: 1, users: [player("ann")] });
  assert.equal(stepsAfter(beside).hint.step, "drive", "who practises beside it is new");
});

test("a hint says what to do with what one holds, and what is to be seen, in each language", () => {
  for (const language of ["de", "it", "en"]) {
    speak(language);
    const said = new Set();
    for (const device of ["keys", "pad", "stick", "gamepad"]) {
      for (const step of ["drive", "turn", "shoot"]) {
        const { text, sight } = hintText(step, device, "arena", 3);
        assert.doesNotMatch(text + sight, /[{}]|undefined/);
        said.add(text);
      }
    }
    assert.equal(said.size, 11, "only the fire button is that of pad and stick");
  }
  assert.match(hintText("drive", "keys", "arena", 3).sight, /marked YOU/);
  assert.match(hintText("drive", "keys", "camera", 3).sight, /camera/);
  assert.match(hintText("drive", "keys", "none", 3).sight, /robot 3/);
  assert.match(hintText("shoot", "pad", "camera", 3).text, /FIRE/);
});
