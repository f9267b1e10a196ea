import assert from "node:assert/strict";
import { test } from "node:test";
import { Roles } from "../../../sim/static/roles.js";
import { playersOf } from "../../../sim/static/game.js";
import { Memory } from "../../../sim/static/memory.js";
import { Motion } from "../../../sim/static/motion.js";
import { rows } from "../../../sim/static/roster.js";
import { languageOf, wordsOf } from "../../../sim/static/words.js";
import { message, player } from "./samples.js";

const WORDS = wordsOf("en");
const robot = (id, values = {}) => ({ name: `virtual${id}`, id, x: 0.5, y: 0.5, heading: 0, beam: false, lit: false, hits: 0, ...values });
const users = [player("al", { ready: true, life: 40 }), player("bo", { robot: 1, ready: true, life: 0 }), player("cy", { robot: 2 })];

test("rosbridge's state tells who plays, who is out and what happens", () => {
  const { phase, players } = playersOf(message({ game: 2, users }));
  assert.equal(phase, "playing");
  assert.deepEqual(players.map(({ name, out, life }) => [name, out, life]), [["al", false, 40], ["bo", true, 0], ["cy", false, 100]]);
  assert.ok(playersOf(message({ game: 0, users })).players.every(({ out }) => !out)); // life 0 is the last battle's
});

test("a battle begins once: when its phase is new", () => {
  const roles = new Roles(WORDS);
  const news = (phase) => ({ me: "al", phase, labels: {}, players: playersOf(message({ users })).players });
  roles.take(news("stopped"), 10);
  assert.equal(roles.sinceStart(11), Infinity);
  roles.take(news("playing"), 20);
  roles.take(news("playing"), 25);
  assert.equal(roles.sinceStart(26), 6);
  assert.deepEqual([roles.drives, roles.of(robot(0)).isMe, roles.of(robot(1)).isMe, roles.of(robot(7))], [true, true, false, undefined]);
});

test("the page's words win, and leave with it", () => {
  const roles = new Roles(WORDS);
  roles.take({ me: null, phase: "", labels: { you: "ICH" }, players: [] }, 0);
  assert.deepEqual([roles.words.you, roles.words.hit, roles.known, roles.drives], ["ICH", "HIT", true, false]);
  roles.take(null, 1);
  assert.deepEqual([roles.words.you, roles.known], ["YOU", false]);
});

test("the list has the players by robot, with the life that is left", () => {
  const roles = new Roles(WORDS);
  const robots = [robot(7), robot(2), robot(1), robot(0)];
  assert.deepEqual(rows(robots, roles, WORDS).map(({ name }) => name), ["Robot 0", "Robot 1", "Robot 2", "Robot 7"]);
  roles.take(playersOf(message({ game: 2, users })), 0);
  const list = rows(robots, roles, WORDS);
  assert.deepEqual(list.map(({ badge, name, state, life }) => [badge, name, state, life]), [
    ["0", "al", "40 %", 40], ["1", "bo", "out", null], ["2", "cy", "not ready", null], ["7", "Robot 7", "", null],
  ]);
  assert.deepEqual(list.map(({ classes }) => [classes.free, classes.out]), [[false, false], [false, true], [false, false], [true, false]]);
});

test("every language has all words, and the reader's first choice wins", () => {
  assert.equal(languageOf(["fr-FR", "de-AT", "it"]), "de");
  assert.equal(languageOf(["ja"]), "en");
  assert.equal(languageOf([]), "en");
  for (const language of ["it", "de"]) assert.deepEqual(Object.keys(wordsOf(language)), Object.keys(WORDS));
});

test("a new hit is told once, and its light fades", () => {
  const memory = new Memory();
  assert.deepEqual(memory.follow([robot(0, { hits: 3 })], 0), []); // hits of before are no news
  assert.equal(memory.flash(robot(0), 0), 0);
  assert.equal(memory.follow([robot(0, { hits: 4 })], 1).length, 1);
  assert.equal(memory.follow([robot(0, { hits: 4 })], 1.1).length, 0);
  assert.ok(memory.flash(robot(0), 1.1) > memory.flash(robot(0), 1.4));
  assert.equal(memory.flash(robot(0), 2), 0);
  assert.equal(memory.flash(robot(0, { lit: true }), 2), 1);
});

test("wheels roll with the robot and its track stays for a while", () => {
  const memory = new Memory();
  for (let n = 0; n <= 10; n++) memory.follow([robot(0, { x: 0.5 + n / 100 })], n / 10);
  const { wheels, track } = memory.of(robot(0));
  assert.ok(Math.abs(wheels[0] - 0.1) < 1e-9 && Math.abs(wheels[1] - 0.1) < 1e-9);
  assert.equal(track.length, 11);
  memory.follow([robot(0, { x: 0.6 })], 9);
  assert.equal(memory.of(robot(0)).track.length, 1);
  memory.follow([], 10);
  assert.equal(memory.of(robot(0)), undefined);
});

test("the picture follows the states closely, and farther behind when they are rarer", () => {
  for (const [gap, most] of [[0.04, 0.1], [0.1, 0.19]]) {
    const motion = new Motion();
    let now = 0;
    for (; now < 6; now += gap) motion.add({ time: now, robots: [robot(0, { x: now })] }, now);
    const before = motion.at(now - gap / 2)[0].x;
    const behind = now - motion.at(now)[0].x;
    assert.ok(behind > gap && behind < most, `${gap}: ${behind}`);
    assert.ok(motion.at(now)[0].x > before); // no standstill between two states
  }
});
