import assert from "node:assert/strict";
import { beforeEach, test } from "node:test";
import { ArenaView } from "../../../server/static/js/common/arena_view.js";

const URL_ = "http://hall.local:8080/?embedded";
const ORIGIN = "http://hall.local:8080";
const NEWS = { me: "Al", phase: "playing", players: [{ name: "Al", robot: 0 }] };

let now, hidden, timers, listeners, frame, states, posts, view;

beforeEach(() => {
  [now, hidden, timers, listeners, states, posts] = [0, false, [], [], [], []];
  let loads = 0;
  frame = {
    hidden: false,
    contentWindow: { postMessage: (message, origin) => posts.push([message, origin]) },
    set src(url) {
      loads += 1;
      assert.equal(url, URL_);
    },
    get loads() {
      return loads;
    },
  };
  const put = (list, entry) => {
    list.push(entry);
    return () => list.splice(list.indexOf(entry), 1);
  };
  const clock = {
    now: () => now,
    isHidden: () => hidden,
    every: (ms, act) => put(timers, { ms, act, at: now + ms }),
    listen: (act) => put(listeners, act),
  };
  view = new ArenaView({ frame, url: ORIGIN, onState: (state) => states.push(state), clock });
});

/** Let so many seconds pass in which the arena says `state` at least every 2 s, or nothing. */
function pass(seconds, state = null) {
  for (const end = now + seconds * 1000; now < end; ) {
    now += 500;
    if (state && now % 1500 === 0) say(state);
    for (const timer of timers) {
      if (timer.at > now) continue;
      timer.at += timer.ms;
      timer.act();
    }
  }
}

function say(state, values = {}) {
  const event = { source: frame.contentWindow, origin: ORIGIN, data: { type: "laserbot-arena", state, fps: 60, effects: 0 }, ...values };
  for (const act of listeners) act(event);
}

test("the frame is hidden until the arena speaks", () => {
  assert.equal(frame.hidden, true);
  assert.equal(frame.loads, 1);
  pass(3);
  assert.equal(frame.hidden, true);
  say("connecting");
  assert.equal(frame.hidden, false);
  say("live");
  assert.deepEqual(states, ["live"]);
  assert.equal(view.report.fps, 60);
});

test("who plays is told when the arena first speaks, at each change of either, and not in between", () => {
  view.show(NEWS);
  assert.equal(posts.length, 0);
  say("connecting");
  assert.deepEqual(posts, [[{ type: "laserbot-players", scale: 1, ...NEWS }, ORIGIN]]);
  say("live");
  assert.equal(posts.length, 2); // it may have begun anew
  pass(20, "live");
  view.show({ ...NEWS });
  assert.equal(posts.length, 2);
  view.show({ ...NEWS, phase: "stopped" });
  assert.equal(posts.length, 3);
  assert.equal(posts[2][0].phase, "stopped");
});

test("how large it is shown is told when that changes, with who plays", () => {
  view.scale = 0.5;
  assert.equal(posts.length, 0);
  view.show(NEWS);
  say("live");
  assert.equal(posts.at(-1)[0].scale, 0.5);
  view.scale = 0.5;
  assert.equal(posts.length, 1);
  view.scale = 1;
  assert.deepEqual(posts.at(-1), [{ type: "laserbot-players", scale: 1, ...NEWS }, ORIGIN]);
});

test("other windows, origins and messages are not the arena", () => {
  say("live", { source: {} });
  say("live", { origin: "http://evil.example" });
  say("live", { data: { type: "webpackOk" } });
  say("live", { data: null });
  say("dancing");
  assert.deepEqual(states, []);
  assert.equal(frame.hidden, true);
});

test("an arena that says nothing for 6 s is unreachable, and is loaded again every 5 s out of sight", () => {
  pass(5.5);
  assert.deepEqual(states, []);
  pass(1);
  assert.deepEqual(states, ["unreachable"]);
  assert.equal(frame.loads, 2);
  pass(20);
  assert.equal(frame.loads, 6);
  assert.equal(frame.hidden, true);
  assert.deepEqual(states, ["unreachable"]);
});

test("it comes back with the players when it is reachable again", () => {
  view.show(NEWS);
  pass(12);
  say("connecting");
  say("live");
  assert.deepEqual(states, ["unreachable", "connecting", "live"]);
  assert.equal(frame.hidden, false);
  assert.equal(posts.at(-1)[0].me, "Al");
  const { loads } = frame;
  pass(60, "live");
  assert.equal(frame.loads, loads);
});

test("an arena that has lost its own feed says so and stays in sight", () => {
  say("live");
  pass(30, "lost");
  assert.deepEqual(states, ["live", "lost"]);
  assert.equal(frame.hidden, false);
  pass(2, "live");
  assert.equal(view.state, "live");
});

test("a page that was hidden or too busy to listen blames nobody", () => {
  say("live");
  hidden = true;
  pass(600);
  hidden = false;
  pass(4);
  say("live");
  now += 30_000; // the thread was blocked: what the arena has said waits behind the timers
  for (const timer of timers) timer.act();
  assert.deepEqual(states, ["live"]);
  assert.equal(frame.loads, 1);
});

test("after its end it neither listens nor looks", () => {
  view.close();
  assert.deepEqual([timers, listeners], [[], []]);
});
