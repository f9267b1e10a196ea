import assert from "node:assert/strict";
import { beforeEach, test } from "node:test";
import { Governor, LEVELS } from "../../../server/static/js/arena/governor.js";

const FAST = 16.7;
const SLOW = 25;

let governor, now, last;

beforeEach(() => {
  governor = new Governor();
  now = last = 0;
});

/** Draw for so many seconds, one picture every `interval` ms. */
function draw(seconds, interval) {
  for (const end = now + seconds * 1000; now < end; now += interval) {
    governor.picture(now, now - last);
    last = now;
  }
}

test("a machine that draws in time keeps all effects", () => {
  draw(60, FAST);
  assert.equal(governor.level, 0);
  assert.equal(governor.effects, LEVELS[0]);
});

test("a second of slow pictures takes one level, the next second another, down to the last", () => {
  draw(1.1, SLOW);
  assert.equal(governor.level, 1);
  draw(1, SLOW);
  assert.equal(governor.level, 2);
  draw(10, SLOW);
  assert.equal(governor.level, LEVELS.length - 1);
});

test("a few late pictures among many are nothing", () => {
  for (let n = 0; n < 30; n++) {
    draw(0.9, FAST);
    now += 60;
  }
  assert.equal(governor.level, 0);
});

test("a screen that was asked for nothing was not slow", () => {
  for (let n = 0; n < 100; n++) {
    governor.rest();
    draw(0.1, FAST);
    now += 400;
  }
  assert.equal(governor.level, 0);
});

test("pictures that are asked for seldom are judged by how long they are waited for", () => {
  for (let n = 0; n < 100; n++) governor.picture((now += 200), 10);
  assert.equal(governor.level, 0);
  for (let n = 0; n < 20; n++) governor.picture((now += 200), 40);
  assert.ok(governor.level > 0);
});

test("each level costs less than the one before", () => {
  for (let n = 1; n < LEVELS.length; n++) {
    for (const part of ["glow", "smoke", "sparks", "density", "pictures"]) assert.ok(LEVELS[n][part] <= LEVELS[n - 1][part]);
  }
  assert.ok(LEVELS.at(-1).density >= 1); // letters stay sharp
});

test("where one picture takes long, there are no more than 30 a second", () => {
  draw(10, 40);
  assert.ok(governor.effects.pictures <= 30);
});

test("effects come back slowly, one by one", () => {
  draw(2.2, SLOW);
  assert.equal(governor.level, 2);
  draw(9, FAST);
  assert.equal(governor.level, 2);
  draw(3, FAST);
  assert.equal(governor.level, 1);
  draw(12, FAST);
  assert.equal(governor.level, 0);
});

test("a level that was too much is tried again only after twice as long", () => {
  draw(1.1, SLOW);
  draw(12, FAST);
  assert.equal(governor.level, 0);
  draw(2, SLOW);
  const level = governor.level;
  assert.ok(level > 0);
  draw(15, FAST);
  assert.equal(governor.level, level);
  draw(10, FAST);
  assert.equal(governor.level, level - 1);
});

test("a hidden tab was not slow", () => {
  draw(5, FAST);
  now += 60_000;
  draw(5, FAST);
  now += 700;
  draw(5, FAST);
  assert.equal(governor.level, 0);
});
