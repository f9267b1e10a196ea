import assert from "node:assert/strict";
import { beforeEach, test } from "node:test";
import { Loop } from "../../../server/static/js/arena/loop.js";
import { DRIFT, isDue, isOther, MOTION, REST } from "../../../server/static/js/arena/pace.js";

const ARENA = { robot_radius: 0.075, beam_range: 2 };
const SCALE = 300; // pixels for a metre
const robot = (values = {}) => ({ name: "virtual0", id: 0, x: 1, y: 1, heading: 3, beam: false, hits: 0, ...values });
const isSeen = (before, after) => isOther([robot(before)], [robot(after)], ARENA, SCALE);

test("a robot that has not moved by half a pixel is the same picture", () => {
  assert.equal(isSeen({}, {}), false);
  assert.equal(isSeen({}, { x: 1.001, y: 1.001 }), false);
  assert.equal(isSeen({}, { x: 1.0015, y: 1.0015 }), true);
});

test("so is one whose edge has not turned by half a pixel, over the end of the circle, too", () => {
  assert.equal(isSeen({ heading: Math.PI - 0.005 }, { heading: -Math.PI + 0.005 }), false);
  assert.equal(isSeen({}, { heading: 3.03 }), true);
});

test("a beam is long: its end is seen to move sooner", () => {
  assert.equal(isSeen({ beam: true }, { beam: true, heading: 3.005 }), true);
});

test("beams, hits and other robots are another picture", () => {
  for (const news of [{ beam: true }, { hits: 1 }, { covered: true }, { id: 7 }, { name: "virtual1" }]) assert.equal(isSeen({}, news), true);
  assert.equal(isOther([robot()], [], ARENA, SCALE), true);
});

test("what goes on is drawn so often as it is worth, what rests never", () => {
  assert.equal(isDue(REST, Infinity), false);
  assert.equal(isDue(DRIFT, 1 / 30), false);
  assert.equal(isDue(DRIFT, 1 / 15), true);
  assert.equal(isDue(MOTION, 1 / 60), true);
});

let loop, screen, timers, asked, now, drawn, looks, waits, intervals;

beforeEach(() => {
  [screen, timers, drawn, looks, waits, intervals, now, asked] = [[], [], [], [], [], [], 0, 0];
  loop = new Loop({
    look: (time, isFirst, waited) => {
      looks.push(isFirst);
      waits.push(waited);
    },
    draw: (time) => {
      drawn.push(time);
      return intervals.shift() ?? null;
    },
    nextPicture: (act) => {
      asked += 1;
      screen.push(act);
    },
    later: (act, ms) => timers.push({ at: now + ms, act }),
  });
});

/** Let so many pictures of a screen of so many a second pass. */
function pass(pictures, rate = 60) {
  for (let n = 0; n < pictures; n++) {
    now += 1000 / rate;
    const due = timers.filter(({ at }) => at <= now);
    timers = timers.filter(({ at }) => at > now);
    for (const { act } of due) act();
    for (const show of screen.splice(0)) show(now);
  }
}

test("nothing is asked of the screen before there is news, nor after a picture that wants no other", () => {
  assert.equal(screen.length, 0);
  loop.wake();
  loop.wake();
  pass(10);
  assert.equal(drawn.length, 1);
  assert.equal(screen.length, 0);
  loop.wake();
  pass(10);
  assert.equal(drawn.length, 2);
  assert.deepEqual(looks, [true, true]);
});

test("as many pictures are drawn as are wanted, whatever the screen's rate is", () => {
  for (const [rate, wanted] of [[60, 60], [60, 30], [50, 30], [144, 60], [144, 30], [75, 15], [60, 15]]) {
    drawn = [];
    intervals = Array(wanted * 10).fill(1000 / wanted);
    loop.wake();
    pass(rate * 5, rate);
    assert.ok(Math.abs(drawn.length - 5 * wanted) <= 2, `${drawn.length / 5} pictures a second of ${wanted} on a screen of ${rate}`);
    intervals = [];
    pass(rate, rate);
  }
});

test("the screen is asked for hardly more pictures than are drawn", () => {
  for (const wanted of [4, 15, 30]) {
    [asked, drawn, intervals] = [0, [], Array(wanted * 10).fill(1000 / wanted)];
    loop.wake();
    pass(300);
    assert.ok(asked <= drawn.length * 1.6, `${asked} for ${drawn.length}`);
    intervals = [];
    pass(60);
  }
});

test("what a picture was waited for does not count the time for which none was wanted", () => {
  intervals = Array(20).fill(250);
  loop.wake();
  pass(300);
  assert.ok(Math.max(...waits) <= 1000 / 60 + 1, `${Math.max(...waits)} ms`);
});

test("a late picture is followed by one sooner, many that were lost are not made up for", () => {
  intervals = Array(200).fill(1000 / 30);
  const later = (ms) => {
    [now, drawn] = [now + ms, []];
    pass(60);
    return drawn.length;
  };
  loop.wake();
  later(0);
  assert.equal(later(15), 31);
  assert.ok(later(500) <= 32);
});
