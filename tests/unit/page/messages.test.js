import assert from "node:assert/strict";
import { test } from "node:test";
import { UNKNOWN_BATTLE, fromReply, fromTopic } from "../../../server/static/js/messages.js";
import { message, player } from "./samples.js";

const reply = (values = {}) => ({ game: 0, status: "OK", timeLeft: 0, users: "[]", ...values });
const al = '[{"ready": 1, "life": 70, "name": "al", "robot": 3}]';

test("a message of the topic keeps what it says", () => {
  const status = fromTopic(message({ game: 2, time_left: 12.5, battle: 7, notice: "n", users: [player("al")], paused: true, message: "m" }));
  assert.deepEqual(
    [status.game, status.timeLeft, status.battle, status.notice, status.users[0].name, status.paused, status.message],
    [2, 12.5, 7, "n", "al", true, "m"],
  );
});

test("a reply's users are JSON in JSON, ready is a number there", () => {
  const status = fromReply(reply({ game: 1, timeLeft: 9, users: al }), null);
  assert.deepEqual([status.game, status.timeLeft], [1, 9]);
  assert.deepEqual(status.users, [{ name: "al", robot: 3, life: 70, ready: true, avatar: 0, place: 0, seat_left: 0, left: false }]);
  assert.deepEqual(fromReply(reply(), null).users, []);
});

test("what a reply does not know stays as it was", () => {
  const values = { battle: 7, notice: "n", paused: true, message: "m" };
  const before = fromTopic(message({ ...values, users: [player("al", { avatar: 4 })], result: [player("al")] }));
  const status = fromReply(reply({ users: al }), before);
  assert.deepEqual([status.battle, status.notice, status.users[0].avatar, status.result.length], [7, "n", 4, 1]);
  assert.deepEqual([status.paused, status.message], [true, "m"]);
  assert.equal(fromReply(reply(), null).battle, UNKNOWN_BATTLE);
});

test("an old result is gone when the next countdown runs", () => {
  const before = fromTopic(message({ result: [player("al")] }));
  assert.deepEqual(fromReply(reply({ game: 1 }), before).result, []);
});
