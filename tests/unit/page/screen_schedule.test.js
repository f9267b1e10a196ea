import assert from "node:assert/strict";
import { beforeEach, test } from "node:test";
import { changes } from "../../../server/static/js/battle/feed.js";
import { Leaders, serverDay } from "../../../server/static/js/results/leaders.js";
import { PODIUM, ScreenSchedule, TURN } from "../../../server/static/js/watch/screen_schedule.js";
import { COUNTDOWN, PLAYING } from "../../../server/static/js/battle/state.js";
import { player, status } from "./samples.js";

const USERS = [player("Al", { ready: true }), player("Bo", { ready: true })];
const RESULT = [player("Al", { place: 1 }), player("Bo", { place: 2, life: 0 })];
const IDLE = status();
const COUNTING = status({ game: COUNTDOWN, users: USERS });
const BATTLE = status({ game: PLAYING, battle: 1, users: USERS });
const OVER = status({ battle: 1, result: RESULT });

let schedule, previous;

beforeEach(() => {
  schedule = new ScreenSchedule();
  previous = null;
});

function take(current, now) {
  schedule.take(current, changes(previous, current), now);
  previous = current;
}

test("before the first state there is nothing to show", () => {
  assert.equal(schedule.panel(0, true), "none");
});

test("countdown and battle go before everything", () => {
  take(COUNTING, 0);
  assert.equal(schedule.panel(0, true), "countdown");
  take(BATTLE, 15_000);
  assert.equal(schedule.panel(15_000, true), "battle");
  assert.equal(schedule.panel(300_000, true), "battle");
});

test("a battle's end is celebrated, then leaderboard and invitation take turns", () => {
  take(BATTLE, 0);
  take(OVER, 1000);
  take(OVER, 1500);
  assert.equal(schedule.panel(1000, true), "podium");
  assert.notEqual(schedule.panel(1000, true, true), "podium", "whoever is asked to vote sees the vote");
  assert.equal(schedule.panel(1000 + PODIUM - 1, true), "podium");
  const idle = 1000 + PODIUM;
  const shown = [0, TURN - 1, TURN, 2 * TURN - 1, 2 * TURN].map((ms) => schedule.panel(idle + ms, true));
  assert.deepEqual(shown, ["leaders", "leaders", "join", "join", "leaders"]);
});

test("the next countdown ends the podium, also when it stops again", () => {
  take(BATTLE, 0);
  take(OVER, 1000);
  take(status({ ...COUNTING, battle: 1, game: COUNTDOWN, users: USERS }), 3000);
  assert.equal(schedule.panel(3000, true), "countdown");
  take(status({ battle: 1 }), 4000);
  assert.notEqual(schedule.panel(4000, true), "podium");
});

test("who opens the page after a battle is invited, not shown an old podium", () => {
  take(OVER, 0);
  assert.equal(schedule.panel(0, false), "join");
});

test("without a leaderboard there is only the invitation", () => {
  take(IDLE, 0);
  for (let now = 0; now < 5 * TURN; now += 1000) assert.equal(schedule.panel(now, false), "join");
});

test("the leaderboard is asked for every 30 s between battles, and not at all during one", async () => {
  let now = 0;
  let asked = 0;
  const ask = async () => [{ place: 1, name: "Al", wins: (asked += 1), battles: 9 }];
  const leaders = new Leaders(ask, { now: () => now, random: () => 0 });
  const pass = async (ms, isBetween) => {
    for (const end = now + ms; now < end; now += 500) await leaders.tick(isBetween);
  };
  await pass(60_000, true);
  assert.equal(asked, 2);
  assert.equal(leaders.players[0].wins, 2);
  await pass(300_000, false);
  assert.equal(asked, 2);
  await pass(5000, true);
  assert.equal(asked, 3, "soon after a battle, when it is in the database");
});

test("a leaderboard that cannot be had leaves the one that is known", async () => {
  const answers = [[{ place: 1, name: "Al", wins: 1, battles: 1 }], null];
  let now = 0;
  const ask = async () => answers.shift() ?? Promise.reject(new Error("503"));
  const leaders = new Leaders(ask, { now: () => now, random: () => 0 });
  await leaders.tick(true);
  now = 60_000;
  await leaders.tick(true);
  assert.equal(leaders.players[0].name, "Al");
});

test("many pages ask at different moments after a battle", async () => {
  const moments = [0, 0.5, 1].map((share) => {
    let now = 0;
    let at = null;
    const leaders = new Leaders(async () => [(at ??= now)], { now: () => now, random: () => share });
    leaders.tick(false);
    for (; at === null; now += 500) leaders.tick(true);
    return at;
  });
  assert.equal(new Set(moments).size, 3);
  assert.ok(Math.max(...moments) < PODIUM, "before the podium is over");
});

test("the day is the server's, wherever the page is", () => {
  const moment = Date.UTC(2026, 10, 24, 23, 30);
  assert.equal(serverDay(moment, 0), "2026-11-24");
  assert.equal(serverDay(moment, 60), "2026-11-25");
  assert.equal(serverDay(Date.UTC(2026, 10, 24, 2), -300), "2026-11-23");
});
