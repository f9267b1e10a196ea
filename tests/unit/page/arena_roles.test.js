import assert from "node:assert/strict";
import { test } from "node:test";
import { Memory } from "../../../server/static/js/arena/memory.js";
import { Roles } from "../../../server/static/js/arena/roles.js";

const robot = (id, values = {}) => ({ name: `Robot${id}`, id, x: 0.5, y: 0.5, heading: 0, beam: false, hits: 0, ...values });

test("a battle begins once: when its phase is new", () => {
  const roles = new Roles({ you: "YOU", hit: "HIT" });
  const news = (phase) => ({ me: "al", phase, players: [{ name: "al", robot: 0, out: false }, { name: "bo", robot: 1, out: true }] });
  assert.equal(roles.known, false);
  roles.take(news("stopped"), 10);
  assert.equal(roles.sinceStart(11), Infinity);
  roles.take(news("playing"), 20);
  roles.take(news("playing"), 25);
  assert.equal(roles.sinceStart(26), 6);
  assert.deepEqual([roles.known, roles.drives, roles.smokes], [true, true, true]);
  assert.deepEqual([roles.of(robot(0)).isMe, roles.of(robot(1)).isMe, roles.of(robot(7))], [true, false, undefined]);
});

test("a new hit is told once, and its light fades", () => {
  const memory = new Memory();
  assert.deepEqual(memory.follow([robot(0, { hits: 3 })], 0), []); // hits of before are no news
  assert.equal(memory.flash(robot(0), 0), 0);
  assert.equal(memory.follow([robot(0, { hits: 4 })], 1).length, 1);
  assert.equal(memory.follow([robot(0, { hits: 4 })], 1.1).length, 0);
  assert.ok(memory.flash(robot(0), 1.1) > memory.flash(robot(0), 1.4));
  assert.equal(memory.flash(robot(0), 2), 0);
});

test("wheels roll with the robot and its track stays for a while", () => {
  const memory = new Memory();
  for (let n = 0; n <= 10; n++) memory.follow([robot(0, { x: 0.5 + n / 100 })], n / 10);
  const { wheels, track } = memory.of(robot(0));
  assert.ok(Math.abs(wheels[0] - 0.1) < 1e-9 && Math.abs(wheels[1] - 0.1) < 1e-9);
  assert.equal(track.length, 11);
  memory.follow([robot(0, { x: 0.6 })], 9);
  assert.equal(memory.of(robot(0)).track.length, 1);
  memory.follow([robot(0, { x: 0.62 })], 9.1);
  memory.follow([robot(0, { x: 1.9 })], 9.2);
  assert.equal(memory.of(robot(0)).track.length, 1, "no way leads from one place to another that far");
  memory.follow([], 10);
  assert.equal(memory.of(robot(0)), undefined);
});
