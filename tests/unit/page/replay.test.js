import assert from "node:assert/strict";
import { test } from "node:test";
import { clock, fighterAt, lengthOf, newsAt, playersAt, pointsAt, poseAt, robotsAt } from "../../../server/static/js/results/replay.js";

const track = {
  times: [1, 2, 4],
  robots: { 0: [[0, 0, 350], [1, 0, 10], [1, 2, 10]], 1: [null, [1, 1, 0], null] },
};
const timeline = [
  { at: 2, name: "ada", what: "hit", life: 60 },
  { at: 3, name: "bob", what: "left", life: 100 },
  { at: 4, name: "ada", what: "hit", life: 0 },
];

test("between two sights a robot drives straight and turns the short way", () => {
  assert.deepEqual(poseAt(track, 0, 1.5), { x: 0.5, y: 0, heading: 360, covered: false });
  assert.deepEqual(poseAt(track, 0, 3), { x: 1, y: 1, heading: 10, covered: false });
});

test("before the first and after the last sight it stands there", () => {
  assert.deepEqual(poseAt(track, 0, 0), { x: 0, y: 0, heading: 350, covered: false });
  assert.deepEqual(poseAt(track, 0, 99), { x: 1, y: 2, heading: 10, covered: false });
});

test("a robot that was covered is marked until it was seen again", () => {
  const hidden = { times: [1, 2, 4], robots: { 0: [[0, 0, 0], [1, 0, 0, true], [2, 0, 0]] } };
  assert.deepEqual([1, 1.9, 2, 3.9, 4].map((at) => poseAt(hidden, 0, at).covered), [false, false, true, true, false]);
  const battle = { fighters: [{ name: "ada", robot: 0 }], timeline: [], track: hidden };
  assert.equal(robotsAt(battle, 2)[0].covered, true);
});

test("a robot that was not seen is nowhere", () => {
  assert.equal(poseAt(track, 1, 1.5), null);
  assert.deepEqual(poseAt(track, 1, 3), { x: 1, y: 1, heading: 0, covered: false });
  assert.equal(poseAt(track, 1, 4), null);
  assert.equal(poseAt(track, 9, 1), null);
});

test("it waits where it was seen last for a sight that comes late", () => {
  const late = { times: [1, 9], robots: { 0: [[0, 0, 0], [1, 1, 90]] } };
  assert.deepEqual(poseAt(late, 0, 8.9), { x: 0, y: 0, heading: 0, covered: false });
  assert.deepEqual(poseAt(late, 0, 9), { x: 1, y: 1, heading: 90, covered: false });
});

test("life, hits and the end of a fighter come from the time line", () => {
  assert.deepEqual(fighterAt(timeline, "ada", 1.9), { life: 100, hits: 0, out: false });
  assert.deepEqual(fighterAt(timeline, "ada", 2.1), { life: 60, hits: 1, out: false });
  assert.deepEqual(fighterAt(timeline, "ada", 9), { life: 0, hits: 2, out: true });
  assert.deepEqual(fighterAt(timeline, "bob", 3.1), { life: 100, hits: 0, out: true });
});

test("who has joined later is not there before, and has the life with which it was", () => {
  const late = [{ at: 5, name: "cy", what: "joined", life: 40 }];
  assert.deepEqual(fighterAt(late, "cy", 4.9), { life: 100, hits: 0, out: true });
  assert.deepEqual(fighterAt(late, "cy", 5), { life: 40, hits: 0, out: false });
});

test("the picture gets the robots that were seen, with who played them", () => {
  const fighters = [{ name: "ada", robot: 0, team: 1 }, { name: "bob", robot: 1, team: 0 }];
  const battle = { fighters, timeline, track, effects: [] };
  assert.deepEqual(robotsAt(battle, 1.5), [{ id: 0, name: "ada", x: 0.5, y: 0, heading: 2 * Math.PI, covered: false, beam: false, hits: 0 }]);
  assert.deepEqual(robotsAt(battle, 3).map(({ name, hits }) => [name, hits]), [["ada", 1], ["bob", 0]]);
  const { me, players } = playersAt(battle, 3.5);
  assert.equal(me, null);
  assert.deepEqual(players.map(({ name, robot, life, out }) => [name, robot, life, out]), [["ada", 0, 60, false], ["bob", 1, 100, true]]);
  assert.ok(players[0].colour && players[1].colour === null);
});

test("what was picked up works until it has ended, or to the end", () => {
  const effects = [
    { name: "ada", what: "shield", since: 2, until: 10 },
    { name: "ada", what: "double damage", since: 5, until: null },
  ];
  const battle = { fighters: [{ name: "ada", robot: 0 }, { name: "bob", robot: 1 }], timeline: [], track, effects };
  const of = (at) => playersAt(battle, at).players.map(({ shield, doubleDamage }) => [shield, doubleDamage]);
  const [none, one, both, other] = [[false, false], [true, false], [true, true], [false, true]];
  assert.deepEqual([1.9, 2, 5, 10, 99].map(of), [[none, none], [one, none], [both, none], [other, none], [other, none]]);
});

test("what has happened is told for a while, the newest three at once", () => {
  const battle = { timeline: [{ at: 2 }, { at: 5 }, { at: 5.5 }, { at: 5.5 }, { at: 20 }] };
  assert.deepEqual([1.9, 2, 5, 5.5, 9.2, 9.5].map((at) => newsAt(battle, at)), [[], [0], [1, 0], [3, 2, 1], [3, 2], []]);
});

test("the points of hills run with the battle", () => {
  const points = [{ at: 3, name: "ada", points: 1 }, { at: 4, name: "ada", points: 2 }, { at: 7, name: "bob", points: 1 }];
  const of = (at) => [...pointsAt({ points }, at)];
  assert.deepEqual([2.9, 3, 6, 99].map(of), [[], [["ada", 1]], [["ada", 2]], [["ada", 2], ["bob", 1]]]);
});

test("a battle that has not ended is as long as its track", () => {
  assert.equal(lengthOf({ seconds: 7.5, timeline: [{ at: 7 }], track }), 7.5);
  assert.equal(lengthOf({ seconds: 7.5, timeline: [{ at: 7.5001 }], track }), 7.501, "the last moment can be seen");
  assert.equal(lengthOf({ seconds: null, timeline: [], track }), 4);
  assert.equal(clock(65.9), "1:06");
});
