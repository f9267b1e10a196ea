import assert from "node:assert/strict";
import { beforeEach, test } from "node:test";
import { BEAT_INTERVAL, FAST_INTERVAL, Heartbeat } from "../../../server/static/js/game/heartbeat.js";

let now, posts, answer, events, heart;

beforeEach(() => {
  now = 0;
  posts = 0;
  answer = () => Promise.resolve({ status: "OK" });
  events = [];
  heart = new Heartbeat({
    post: () => {
      posts += 1;
      return answer();
    },
    now: () => now,
    onReply: () => events.push("reply"),
    onLost: () => events.push("lost"),
    onBack: () => events.push("back"),
  });
});

/** Ticks every 100 ms for `ms`, as many sources would do together. */
async function beat(ms, isOnlySource = false) {
  for (const end = now + ms; now < end; now += 100) await heart.tick(isOnlySource);
}

test("the server hears from the page at least every 3 s however many ticks there are", async () => {
  await beat(60_000);
  assert.ok(BEAT_INTERVAL <= 3000);
  assert.equal(posts, 60_000 / BEAT_INTERVAL);
});

test("as the only source of the state it beats as often as pages have always polled", async () => {
  await beat(10_000, true);
  assert.equal(posts, 10_000 / FAST_INTERVAL);
});

test("one failure is no loss", async () => {
  answer = () => Promise.reject(new Error("no route"));
  await heart.tick(false);
  assert.equal(heart.lost, false);
  assert.deepEqual(events, []);
});

test("a lost server is told once, asked often, and its return is told before its state", async () => {
  answer = () => Promise.reject(new Error("no route"));
  await beat(5000);
  assert.equal(heart.lost, true);
  assert.deepEqual(events, ["lost"]);
  assert.equal(posts, 5000 / FAST_INTERVAL);
  answer = () => Promise.resolve({ status: "OK" });
  await beat(FAST_INTERVAL);
  assert.equal(heart.lost, false);
  assert.deepEqual(events, ["lost", "back", "reply"]);
});

test("a slow answer is waited for, not asked for again", async () => {
  let finish;
  answer = () => new Promise((resolve) => (finish = resolve));
  const first = heart.tick(false);
  now = 10_000;
  await heart.tick(false);
  assert.equal(posts, 1);
  finish({ status: "OK" });
  await first;
  assert.deepEqual(events, ["reply"]);
});
