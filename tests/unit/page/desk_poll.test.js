import assert from "node:assert/strict";
import { beforeEach, test } from "node:test";
import { INTERVAL, Poll } from "../../../server/static/js/desk/poll.js";

let now, asked, answer, told, poll;

beforeEach(() => {
  [now, asked, told] = [50_000, 0, []];
  answer = async () => ({ battle: 1 });
  poll = new Poll({
    ask: () => {
      asked += 1;
      return answer();
    },
    now: () => now,
    onState: (state) => told.push(state),
    onLost: (since, error) => told.push([since, error.message]),
    onSignedOut: () => told.push("signed out"),
  });
});

const failing = (status) => async () => {
  throw Object.assign(new Error("no"), { status });
};

test("it asks at once, then each second", async () => {
  for (const [ms, questions] of [[0, 1], [INTERVAL - 1, 1], [1, 2], [INTERVAL, 3]]) {
    now += ms;
    await poll.tick(false);
    assert.equal(asked, questions);
  }
  assert.deepEqual(told, Array(3).fill({ battle: 1 }));
});

test("nobody looks: nothing is asked; somebody looks again: it is asked at once", async () => {
  await poll.tick(false);
  now += 60_000;
  await poll.tick(true);
  assert.equal(asked, 1);
  await poll.tick(false);
  assert.equal(asked, 2);
});

test("a slow answer is waited for", async () => {
  let reply;
  answer = () => new Promise((resolve) => (reply = resolve));
  const first = poll.tick(false);
  now += 5 * INTERVAL;
  const second = poll.tick(false);
  assert.equal(asked, 1);
  answer = async () => ({ battle: 3 });
  reply({ battle: 2 });
  await Promise.all([first, second]);
  assert.deepEqual(told, [{ battle: 2 }, { battle: 3 }], "what was asked for meanwhile follows");
});

test("after a failure it tells since when there was no answer, and goes on", async () => {
  await poll.tick(false);
  answer = failing(undefined);
  for (let i = 0; i < 2; i += 1) {
    now += INTERVAL;
    await poll.tick(false);
  }
  answer = async () => ({ battle: 2 });
  now += INTERVAL;
  await poll.tick(false);
  assert.deepEqual(told, [{ battle: 1 }, [50_000, "no"], [50_000, "no"], { battle: 2 }]);
});

test("a visitor who is not signed in is told once, and nothing more is asked", async () => {
  answer = failing(401);
  await poll.tick(false);
  now += INTERVAL;
  await poll.tick(false);
  assert.deepEqual([asked, told], [1, ["signed out"]]);
});
