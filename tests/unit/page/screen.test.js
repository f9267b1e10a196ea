import assert from "node:assert/strict";
import { beforeEach, test } from "node:test";
import { Awake, connectFullscreen } from "../../../server/static/js/common/screen.js";

const settled = () => new Promise((resolve) => setImmediate(resolve));

let page, locks, answer, awake;

/** A page whose screen may be kept awake; the browser lets go of its locks while it is hidden. */
beforeEach(() => {
  page = Object.assign(new EventTarget(), { visibilityState: "visible" });
  locks = [];
  answer = async () => {
    const lock = { released: false, release: async () => (lock.released = true) };
    locks.push(lock);
    return lock;
  };
  awake = new Awake({ request: () => answer() }, page);
});

function setVisible(visible) {
  page.visibilityState = visible ? "visible" : "hidden";
  if (!visible) for (const lock of locks) lock.released = true;
  page.dispatchEvent(new Event("visibilitychange"));
}

const held = () => locks.filter((lock) => !lock.released).length;

test("the screen stays awake while it is wanted", async () => {
  awake.hold(true);
  awake.hold(true);
  await settled();
  assert.equal(held(), 1);
  awake.hold(true);
  await settled();
  assert.equal(locks.length, 1);
  awake.hold(false);
  await settled();
  assert.equal(held(), 0);
});

test("a page that comes back into view keeps it awake again, if that is still wanted", async () => {
  awake.hold(true);
  await settled();
  setVisible(false);
  await settled();
  assert.equal(held(), 0);
  setVisible(true);
  await settled();
  assert.equal(held(), 1);
  awake.hold(false);
  setVisible(false);
  setVisible(true);
  await settled();
  assert.equal(held(), 0);
});

test("a wish that ends while the browser still thinks is no wish", async () => {
  awake.hold(true);
  awake.hold(false);
  await settled();
  assert.equal(held(), 0);
});

test("where it is refused or unknown nothing happens, and the next chance is taken", async () => {
  const working = answer;
  answer = async () => {
    throw new Error("battery low");
  };
  awake.hold(true);
  await settled();
  answer = working;
  setVisible(true);
  await settled();
  assert.equal(held(), 1);
  const unknown = new Awake(undefined, page);
  unknown.hold(true);
  unknown.hold(false);
});

/** A button and a page that can or cannot fill the screen. */
function fullscreen(fullscreenEnabled) {
  const button = Object.assign(new EventTarget(), { hidden: false, pressed: null, setAttribute: (_, value) => (button.pressed = value) });
  const whole = Object.assign(new EventTarget(), { fullscreenEnabled, fullscreenElement: null });
  const change = (element) => async () => {
    whole.fullscreenElement = element;
    whole.dispatchEvent(new Event("fullscreenchange"));
  };
  whole.documentElement = { requestFullscreen: change({}) };
  whole.exitFullscreen = change(null);
  connectFullscreen(button, whole);
  return { button, whole };
}

test("a click gives the page the whole screen, the next takes it back, and the button tells", () => {
  const { button, whole } = fullscreen(true);
  const told = [button.pressed];
  for (let clicks = 0; clicks < 2; clicks += 1) {
    button.dispatchEvent(new Event("click"));
    told.push(button.pressed);
  }
  assert.deepEqual(told, ["false", "true", "false"]);
  whole.documentElement.requestFullscreen = async () => {
    throw new Error("refused");
  };
  button.dispatchEvent(new Event("click"));
  assert.equal(button.pressed, "false");
});

test("a browser that cannot has no such button", () => {
  assert.equal(fullscreen(undefined).button.hidden, true);
  assert.equal(fullscreen(false).button.hidden, true);
  assert.equal(fullscreen(true).button.hidden, false);
});
