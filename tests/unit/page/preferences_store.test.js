import assert from "node:assert/strict";
import { test } from "node:test";
import { Preferences } from "../../../server/static/js/common/preferences_store.js";

const STANDARD = { sound: true, volume: 0.7, touch: "pad", hints: true, guide: true, view: "camera" };
const all = (preferences) => Object.fromEntries(Object.keys(STANDARD).map((name) => [name, preferences.get(name)]));

function storageWith(text) {
  const kept = new Map(text === undefined ? [] : [["laserbot-controls", text]]);
  return { getItem: (key) => kept.get(key) ?? null, setItem: (key, value) => kept.set(key, value) };
}

test("what is chosen is there after a reload", () => {
  const storage = storageWith();
  const first = new Preferences(() => storage);
  assert.deepEqual(all(first), STANDARD);
  first.set("touch", "stick");
  first.set("volume", 0.3);
  first.toggle("sound");
  assert.deepEqual(all(new Preferences(() => storage)), { sound: false, volume: 0.3, touch: "stick", hints: true, guide: true, view: "camera" });
});

test("what is kept and makes no sense is left alone, the rest counts", () => {
  const broken = ["", "null", "[]", "7", "{", '{"volume": 2, "sound": "no", "touch": "wheel", "hints": null, "guide": 0, "view": "moon", "more": 1}', '{"volume": null}'];
  for (const text of broken) assert.deepEqual(all(new Preferences(() => storageWith(text))), STANDARD, text);
  const half = new Preferences(() => storageWith('{"volume": -1, "sound": false}'));
  assert.deepEqual(all(half), { ...STANDARD, sound: false });
});

test("a browser that blocks storage keeps the choice until the page is left", () => {
  const preferences = new Preferences(() => {
    throw new Error("blocked");
  });
  preferences.set("touch", "stick");
  assert.equal(preferences.get("touch"), "stick");
});

test("a value that is none is refused and changes nothing", () => {
  const preferences = new Preferences(() => storageWith());
  for (const [name, value] of [["volume", NaN], ["volume", 1.1], ["volume", "0.5"], ["touch", "wheel"], ["sound", 1], ["colour", "red"]]) {
    assert.throws(() => preferences.set(name, value), /no preference/);
  }
  assert.deepEqual(all(preferences), STANDARD);
});

test("each change is told by its name", () => {
  const preferences = new Preferences(() => storageWith());
  const told = [];
  preferences.watch((name) => told.push([name, preferences.get(name)]));
  preferences.set("hints", false);
  preferences.toggle("sound");
  assert.deepEqual(told, [["hints", false], ["sound", false]]);
});
