import assert from "node:assert/strict";
import { beforeEach, test } from "node:test";
import { Driver } from "../../../server/static/js/drive/driver.js";
import { Gamepads, padState } from "../../../server/static/js/drive/gamepad.js";
import { NEUTRAL } from "../../../server/static/js/drive/keys.js";

const [A, RT, SELECT, START, UP, DOWN, LEFT, RIGHT] = [0, 7, 8, 9, 12, 13, 14, 15];

/** A gamepad with the stick at x, y and these buttons pressed. */
const gamepad = ({ x = 0, y = 0, down = [], index = 0, mapping = "standard" } = {}) => ({
  index, mapping, connected: true, axes: [x, y, 0, 0],
  buttons: Array.from({ length: 17 }, (_, number) => ({ pressed: down.includes(number), value: Number(down.includes(number)) })),
});
const held = (values) => padState(gamepad(values)).held;

test("the left stick drives in eight directions", () => {
  assert.deepEqual(held({ y: -1 }), ["up"]);
  assert.deepEqual(held({ x: 1 }), ["right"]);
  assert.deepEqual(new Set(held({ x: -0.7, y: 0.7 })), new Set(["down", "left"]));
});

test("a worn stick that does not rest in the middle does not drive", () => {
  assert.deepEqual(held({ x: 0.17, y: -0.17 }), []);
  assert.deepEqual(held({ x: 0.26 }), ["right"]);
});

test("the cross drives too, and its opposite does not count twice", () => {
  assert.deepEqual(held({ down: [UP, LEFT] }), ["up", "left"]);
  assert.deepEqual(held({ down: [DOWN, RIGHT] }), ["down", "right"]);
  assert.deepEqual(held({ y: -1, down: [UP] }), ["up"]);
});

test("A and the right trigger fire, the trigger from half its way", () => {
  assert.deepEqual(held({ down: [A] }), ["shoot"]);
  assert.deepEqual(held({ down: [A, RT] }), ["shoot"]);
  const pad = gamepad();
  pad.buttons[RT].value = 0.3;
  assert.deepEqual(padState(pad).held, []);
  pad.buttons[RT].value = 0.6;
  assert.deepEqual(padState(pad).held, ["shoot"]);
});

test("Start and Select are for the page, other buttons for nobody", () => {
  assert.deepEqual(padState(gamepad({ down: [START] })), { held: [], pressed: ["ready"] });
  assert.deepEqual(padState(gamepad({ down: [SELECT] })), { held: [], pressed: ["mute"] });
  assert.deepEqual(padState(gamepad({ down: [1, 2, 3, 4, 5, 6, 10, 11, 16] })), { held: [], pressed: [] });
});

test("of an unknown gamepad only the stick and the first button count", () => {
  const state = padState(gamepad({ y: 1, down: [A, RT, SELECT, START, UP], mapping: "" }));
  assert.deepEqual(state, { held: ["down", "shoot"], pressed: [] });
  assert.deepEqual(padState({ mapping: "", axes: [], buttons: [] }), { held: [], pressed: [] });
});

let pads, frames, sent, presses, counts, changes, isOurs, driver, all;

beforeEach(() => {
  pads = [null, null, null, null];
  frames = [];
  sent = [];
  presses = [];
  counts = [];
  changes = 0;
  isOurs = true;
  driver = new Driver({ send: (command) => sent.push(command), every: () => () => {} });
  all = new Gamepads({
    driver,
    getPads: () => pads,
    nextFrame: (look) => frames.push(look),
    isOurs: () => isOurs,
    onChange: () => (changes += 1),
    onPress: (action) => presses.push(action),
    onCount: (count) => counts.push(count),
  });
});

/** The browser draws its next picture. */
const frame = () => frames.splice(0).forEach((look) => look());

function show(...states) {
  pads = [null, null, null, null];
  for (const state of states) pads[state.index ?? 0] = gamepad(state);
  frame();
}

test("without a gamepad nothing is looked at; with one it is, until it goes", () => {
  all.update();
  assert.equal(frames.length, 0);
  pads[0] = gamepad();
  all.update();
  assert.equal(frames.length, 1);
  all.update();
  assert.equal(frames.length, 1);
  pads[0] = null;
  all.update();
  frame();
  assert.equal(frames.length, 0);
  assert.deepEqual(counts, [0, 1, 1, 0]);
  pads[2] = gamepad({ index: 2 });
  all.update();
  assert.equal(frames.length, 1);
});

test("what is held drives, what is let go stops with one neutral command", () => {
  driver.start();
  pads[0] = gamepad();
  all.update();
  sent.length = 0;
  show({ y: -1, down: [A] });
  show({ y: -1, down: [A] });
  show({});
  show({});
  assert.deepEqual(sent, [{ linear_x: 1, angular_z: 0, shoot: true }, NEUTRAL]);
  assert.equal(changes, 2);
});

test("a stick that is held when the battle begins drives from its first moment", () => {
  pads[0] = gamepad({ y: -1 });
  all.update();
  frame();
  assert.deepEqual(sent, []);
  driver.start();
  frame();
  assert.deepEqual(sent, [NEUTRAL, { linear_x: 1, angular_z: 0, shoot: false }]);
});

test("several gamepads do not disturb each other, and a cable pulled out lets go", () => {
  driver.start();
  pads[0] = gamepad({ y: -1 });
  pads[1] = gamepad({ index: 1, x: 1 });
  all.update();
  assert.deepEqual(driver.actions, new Set(["up", "right"]));
  pads[0] = null;
  all.update();
  assert.deepEqual(driver.actions, new Set(["right"]));
  pads[1] = null;
  all.update();
  assert.deepEqual(driver.actions, new Set());
  assert.deepEqual(sent.at(-1), NEUTRAL);
});

test("Start counts once a press, on each gamepad", () => {
  pads[0] = gamepad();
  all.update();
  show({ down: [START] });
  show({ down: [START] });
  show({});
  show({ down: [START, SELECT] });
  assert.deepEqual(presses, ["ready", "mute", "ready"]);
});

test("in another window or under a dialog a gamepad holds nothing", () => {
  driver.start();
  pads[0] = gamepad();
  all.update();
  show({ y: -1 });
  isOurs = false;
  show({ y: -1, down: [START] });
  assert.deepEqual(driver.actions, new Set());
  assert.deepEqual(presses, []);
  isOurs = true;
  show({ y: -1 });
  assert.deepEqual(driver.actions, new Set(["up"]));
});
