import assert from "node:assert/strict";
import { test } from "node:test";
import { Preferences } from "../../../server/static/js/common/preferences_store.js";
import { SOUNDS, lengthOf, noiseSamples, schedule } from "../../../server/static/js/common/sound.js";
import { Speaker } from "../../../server/static/js/common/speaker.js";

const NAMES = Object.keys(SOUNDS);
const inMemory = () => new Preferences(() => null);

test("each sound is short: the next thing that happens is heard", () => {
  for (const name of NAMES) assert.ok(lengthOf(name) > 0.05 && lengthOf(name) <= 1.3, `${name}: ${lengthOf(name)} s`);
  assert.ok(lengthOf("tick") < 0.2 && lengthOf("shot") < 0.5);
});

test("a voice of noise is no longer than the noise that is made", () => {
  const noises = Object.values(SOUNDS).flat().filter(({ wave }) => wave === "noise");
  assert.ok(noises.length > 0);
  for (const { lasts } of noises) assert.ok(lasts <= 1);
});

test("the heartbeat is quieter than what happens in the battle", () => {
  const loudest = (name) => Math.max(...SOUNDS[name].map(({ level }) => level));
  for (const name of ["hit", "out", "go", "win", "lose"]) assert.ok(loudest("heartbeat") < loudest(name), name);
});

test("a sound's values come in the order of time, from silence to silence, and never reach 0, which no ramp can", () => {
  for (const name of NAMES) {
    for (const { start, stop, level, pitch = [], below = [] } of schedule(name, 5)) {
      assert.ok(start >= 5 && stop <= 5 + lengthOf(name) + 1e-9, name);
      for (const course of [level, pitch, below]) {
        const times = course.map(([moment]) => moment);
        assert.deepEqual(times, times.toSorted((one, other) => one - other), name);
        assert.ok(course.every(([moment, value]) => moment >= start && moment <= stop && value > 0), name);
      }
      assert.ok(level[0][1] < 0.001 && level.at(-1)[1] < 0.001, name);
    }
  }
});

test("only noise has no pitch", () => {
  for (const voice of NAMES.flatMap((name) => schedule(name, 0))) assert.equal(voice.pitch === undefined, voice.wave === "noise");
});

test("noise is even, within its limits and the same each time", () => {
  const samples = noiseSamples(20_000);
  assert.ok(samples.every((sample) => sample >= -1 && sample < 1));
  assert.ok(Math.abs(samples.reduce((sum, sample) => sum + sample, 0) / samples.length) < 0.02);
  assert.deepEqual(noiseSamples(100), samples.slice(0, 100));
});

test("without audio, or where it cannot be opened, the game goes on in silence", () => {
  class Refusing {
    constructor() {
      throw new Error("no device");
    }
  }
  for (const Context of [undefined, Refusing]) {
    const preferences = inMemory();
    const speaker = new Speaker(preferences, Context);
    for (let touches = 0; touches < 2; touches += 1) {
      speaker.wake();
      speaker.play("shot");
    }
    speaker.repeat("heartbeat", 1);
    speaker.quiet();
    preferences.set("volume", 0.2);
  }
});
