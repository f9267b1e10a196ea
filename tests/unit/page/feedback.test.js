import assert from "node:assert/strict";
import { beforeEach, test } from "node:test";
import { Feedback, isLow, moments } from "../../../server/static/js/battle/feedback.js";
import { shakeFrames } from "../../../server/static/js/common/jolt.js";
import { SOUNDS } from "../../../server/static/js/common/sound.js";
import { hit, player, status } from "./samples.js";

const me = (values = {}) => player("Ann", { ready: true, ...values });
const other = (values = {}) => player("Bob", { ready: true, robot: 1, ...values });
const playing = (life, values = {}) => status({ game: 2, battle: 1, time_left: 100, users: [me({ life }), other()], ...values });
const countdown = (time_left, values = {}) => status({ game: 1, battle: 1, time_left, users: [me(), other()], ...values });
const ended = (place, life = 50) =>
  status({ battle: 1, users: [me({ life, ready: false }), other()], result: [me({ place, life }), other({ place: 3 - place })] });

const happened = (previous, current) => moments(previous, current, "Ann");

let felt, feedback;

beforeEach(() => {
  felt = [];
  feedback = new Feedback({
    speaker: {
      play: (name) => felt.push(`play ${name}`),
      repeat: (name, seconds) => felt.push(`repeat ${name} ${seconds}`),
      quiet: () => felt.push("quiet"),
    },
    vibrate: (pattern) => felt.push(`vibrate ${pattern.join()}`),
    jolt: (kind) => felt.push(`jolt ${kind}`),
  });
});

/** What is felt of a change, but for the heart, which does not beat. */
function taken(previous, current) {
  feedback.take(previous, current, "Ann");
  return felt.splice(0).filter((one) => one !== "quiet");
}

test("the countdown ticks once a second, the last three seconds higher, then the battle begins", () => {
  assert.deepEqual(happened(status({ users: [me(), other()] }), countdown(15)), ["tick"]);
  assert.deepEqual(happened(countdown(15), countdown(14.5)), []);
  assert.deepEqual(happened(countdown(14.5), countdown(14)), ["tick"]);
  assert.deepEqual(happened(countdown(3.4), countdown(3)), ["last"]);
  assert.deepEqual(happened(countdown(1.2), countdown(0.9)), ["last"]);
  assert.deepEqual(happened(countdown(0.4), countdown(0)), []);
  assert.deepEqual(happened(countdown(0.4), playing(100)), ["go"]);
});

test("a countdown that stands still or ends without a battle is silent", () => {
  assert.deepEqual(happened(countdown(9.8), countdown(9.8, { paused: true })), []);
  assert.deepEqual(happened(countdown(9.8), status({ users: [me(), other({ ready: false })] })), []);
});

test("a page that has just been opened knows no news", () => {
  for (const current of [countdown(3), playing(10), playing(0), ended(1)]) assert.deepEqual(happened(null, current), []);
});

test("life lost is a hit, the last of it is the end of the robot", () => {
  assert.deepEqual(happened(playing(100), playing(90)), ["hit"]);
  assert.deepEqual(happened(playing(10), playing(0)), ["out"]);
  assert.deepEqual(happened(playing(90), playing(90)), []);
  assert.deepEqual(happened(playing(0), playing(0)), []);
});

test("another player's hit is not felt", () => {
  const hurt = status({ game: 2, battle: 1, users: [me(), other({ life: 40 })] });
  assert.deepEqual(happened(playing(100), hurt), []);
});

test("a shot of this player's that has met somebody is felt, and one that took the last life more", () => {
  const fight = (life, events) => status({ game: 2, battle: 1, users: [me(), other({ life })], events });
  const first = fight(90, [hit(1, "Ann", "Bob", 90)]);
  assert.deepEqual(happened(fight(100, []), first), ["given"]);
  assert.deepEqual(happened(first, fight(0, [...first.events, hit(2, "Ann", "Bob", 0)])), ["kill"]);
  assert.deepEqual(happened(first, first), []);
  assert.deepEqual(taken(fight(100, []), first), ["play given", "vibrate 35"]);
  assert.deepEqual(happened(fight(100, []), fight(90, [hit(1, "", "Bob", 90)])), [], "the light does not tell whose it was");
  assert.ok("given" in SOUNDS && "kill" in SOUNDS);
});

test("the end is a victory for the first, also for those who share that place, and a defeat for all others", () => {
  assert.deepEqual(happened(playing(50), ended(1)), ["win"]);
  assert.deepEqual(happened(playing(50), ended(2)), ["lose"]);
  const draw = status({ battle: 1, users: [me(), other()], result: [me({ place: 1 }), other({ place: 1 })] });
  assert.deepEqual(happened(playing(100), draw), ["win"]);
});

test("the hit that ends the battle is felt, and the end is heard", () => {
  assert.deepEqual(happened(playing(10), ended(2, 0)), ["out", "lose"]);
  assert.deepEqual(taken(playing(10), ended(2, 0)), ["play lose", "vibrate 300", "jolt out"]);
});

test("a hit sounds, buzzes for 80 ms and jolts", () => {
  assert.deepEqual(taken(playing(100), playing(90)), ["play hit", "vibrate 80", "jolt hit"]);
});

test("a tick is heard only", () => {
  assert.deepEqual(taken(countdown(9.5), countdown(9)), ["play tick"]);
});

test("everything that is felt has a sound that exists", () => {
  for (const [previous, current] of [
    [countdown(9.5), countdown(9)], [countdown(3.5), countdown(3)], [countdown(0.1), playing(100)], [playing(90), playing(80)],
    [playing(10), playing(0)], [playing(90), ended(1)], [playing(90), ended(2)],
  ]) {
    const [sound] = taken(previous, current);
    assert.ok(sound.slice("play ".length) in SOUNDS, sound);
  }
});

test("the heart is heard with little life left, while its player fights and the battle runs", () => {
  assert.ok(isLow(playing(20), "Ann"));
  assert.ok(!isLow(playing(30), "Ann"));
  assert.ok(!isLow(playing(0), "Ann"));
  assert.ok(!isLow(playing(10, { paused: true }), "Ann"));
  assert.ok(!isLow(ended(1, 10), "Ann"));
  assert.ok(!isLow(playing(10), "Nobody"));
  feedback.take(playing(20), playing(20), "Ann");
  feedback.take(playing(20), ended(1, 20), "Ann");
  feedback.stop();
  assert.deepEqual(felt.filter((one) => !one.startsWith("play win") && !one.startsWith("vibrate")), ["repeat heartbeat 1.1", "quiet", "quiet"]);
});

test("a held fire button sounds once a shot", () => {
  const shots = [];
  for (let now = 0; now < 1200; now += 25) if (feedback.fire(now)) shots.push(now);
  assert.deepEqual(shots, [0, 500, 1000]);
  assert.deepEqual(felt, ["play shot", "play shot", "play shot"]);
});

test("a shaken stage begins and ends in its place and never goes further than told", () => {
  const ways = shakeFrames(10).map(({ transform }) => Number(/-?[\d.]+/.exec(transform)[0]));
  assert.equal(ways[0], 0);
  assert.equal(ways.at(-1), 0);
  assert.equal(Math.max(...ways.map(Math.abs)), 10);
});
