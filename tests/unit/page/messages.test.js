import assert from "node:assert/strict";
import { test } from "node:test";
import { UNKNOWN_BATTLE, fromReply, fromTopic } from "../../../server/static/js/battle/messages.js";
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

test("how long nobody can be hit is told by the topic only", () => {
  const safe = fromTopic(message({ game: 2, protection: 2.5 }));
  assert.equal(safe.protection, 2.5);
  assert.equal(fromTopic(message()).protection, 0);
  assert.equal(fromReply(reply({ game: 2 }), safe).protection, 0, "else it would never end");
});

test("a reply's users are JSON in JSON, ready is a number there", () => {
  const status = fromReply(reply({ game: 1, timeLeft: 9, users: al }), null);
  assert.deepEqual([status.game, status.timeLeft], [1, 9]);
  const unknown = { may_join: false, fence: 0, avatar: 0, place: 0, seat_left: 0, left: false, team: 0, handicap: 0, shots: 0, hits: 0, kills: 0, points: 0, effects: 0, taken: 0, seconds: 0, wins: 0, weak: false };
  assert.deepEqual(status.users, [{ name: "al", robot: 3, life: 70, ready: true, ...unknown }]);
  assert.deepEqual(fromReply(reply(), null).users, []);
});

test("what a reply does not know stays as it was", () => {
  const values = { battle: 7, notice: "n", paused: true, message: "m" };
  const before = fromTopic(message({ ...values, teams: 2, coded: true, users: [player("al", { avatar: 4, team: 2, weak: true })], result: [player("al")] }));
  const status = fromReply(reply({ users: al }), before);
  assert.deepEqual([status.battle, status.notice, status.users[0].avatar, status.result.length], [7, "n", 4, 1]);
  assert.deepEqual([status.paused, status.message], [true, "m"]);
  assert.deepEqual([status.teams, status.coded, status.users[0].team, status.users[0].weak], [2, true, 2, true]);
  assert.equal(fromReply(reply(), null).battle, UNKNOWN_BATTLE);
});

test("an old result is gone when the next countdown runs", () => {
  const before = fromTopic(message({ result: [player("al")] }));
  assert.deepEqual(fromReply(reply({ game: 1 }), before).result, []);
});

test("a server that knows neither teams nor shooters has none", () => {
  const { name, robot, life, ready, avatar } = player("al");
  const old = fromTopic({ ...message(), users: [{ name, robot, life, ready, avatar }] });
  assert.deepEqual([old.teams, old.coded, old.events, old.users[0].team, old.users[0].weak], [0, false, null, 0, false]);
});

test("only the topic tells hits: a reply does not know whether there were more", () => {
  const events = [{ number: 3, kind: 0, name: "al", by: "bo", life: 70 }];
  const before = fromTopic(message({ events }));
  assert.deepEqual(before.events, events);
  assert.equal(fromReply(reply(), before).events, null);
});
