import assert from "node:assert/strict";
import { test } from "node:test";
import { fromReply } from "../../../server/static/js/battle/messages.js";
import * as state from "../../../server/static/js/battle/state.js";
import { hit, player, status } from "./samples.js";

const ready = { ready: true };
const text = (values, me) => state.gameText(status({ ...values, users: [player("Ann", me), player("Bob", ready)] }), "Ann");

test("a player who is not ready is asked to press Ready", () => {
  assert.equal(text({}).text, "Press Ready to start!");
});

test("who is ready alone waits for others", () => {
  assert.equal(text({}, ready).text, "Waiting for other players...");
});

test("the countdown shows the seconds that have begun", () => {
  assert.equal(text({ game: 1, time_left: 14.2 }, ready).text, "15 sec to start.");
  assert.equal(text({ game: 1, time_left: 0.4 }, ready).text, "1 sec to start.");
});

test("who is not ready in the countdown sees it too and may join", () => {
  const { text: line, hint } = text({ game: 1, time_left: 3 });
  assert.equal(line, "3 sec to start.");
  assert.match(hint, /join/);
});

test("in the battle the players play, the dead watch and the others wait", () => {
  assert.equal(text({ game: 2 }, ready).text, "PLAY!");
  assert.match(text({ game: 2 }, { ready: true, life: 0 }).text, /^You are out: watch/);
  assert.match(text({ game: 2 }).text, /started without you/);
});

test("who plays and is refused is told so in place of PLAY!, and why", () => {
  const playing = status({ game: 2, users: [player("Ann", ready)] });
  const refused = (reason) => state.gameText(playing, "Ann", state.refusalText(reason));
  const reasons = {
    "only signed-in players and operators may publish on /Robot3/command": /not signed in/,
    "Ann may not drive: nothing heard from the referee": /referee is silent/,
    "Ann may publish on /Robot1/command only, not /Robot3/command": /Robot1/,
  };
  for (const [reason, words] of Object.entries(reasons)) {
    assert.equal(refused(reason).text, "Your robot does not obey");
    assert.match(refused(reason).hint, words);
  }
});

test("while nobody can be hit, the seconds that have begun are told, to who fights by voice, too", () => {
  assert.equal(state.protectionText(2.1), "Safe for 3 s");
  assert.equal(state.protectionText(0), "");
  const at = (game, protection, me) => status({ game, protection, users: [player("Ann", me)] });
  assert.match(state.announcement(at(1, 0, ready), at(2, 3, ready), "Ann"), /PLAY!.* Safe for 3 s$/);
  assert.doesNotMatch(state.announcement(at(1, 0, ready), at(2, 0, ready), "Ann"), /Safe/);
  assert.doesNotMatch(state.announcement(at(1, 0, {}), at(2, 3, {}), "Ann"), /Safe/);
});

test("whoever takes less damage is told so before the battle, with the reason", () => {
  const hint = (handicap) => text({ game: 1, time_left: 9 }, { ready: true, handicap }).hint;
  assert.equal(hint(30), "You lost three battles in a row: now hits take 30% less from you.");
  assert.notEqual(hint(0), hint(30));
  assert.equal(state.handicapText(player("Bob", { handicap: 30 })), "30% less damage");
  assert.equal(state.handicapText(player("Bob")), "");
});

test("after the battle its players see that it is over until they are ready again", () => {
  const over = { result: [player("Ann", { place: 1 })], notice: "Battle over: Bob was shot down." };
  assert.deepEqual(text(over), { text: "Game over. Press Ready to play again.", hint: "Battle over: Bob was shot down." });
  assert.equal(text(over, ready).text, "Waiting for other players...");
});

test("who has not fought in a battle does not read how it ended", () => {
  const { text: line, hint } = text({ result: [player("Bob")], notice: "Battle over: Bob was shot down." });
  assert.equal(line, "Press Ready to start!");
  assert.doesNotMatch(hint, /Bob/);
});

test("the server's reason for a stopped countdown is shown", () => {
  const notice = "Countdown stopped: Bob signed out, fewer than two players are ready.";
  assert.equal(text({ notice }).hint, notice);
});

test("a player who is not in the status has no phase and cannot drive", () => {
  const strange = status({ game: 2, users: [player("Bob", ready)] });
  assert.equal(state.phaseOf(strange, "Ann"), null);
  assert.ok(!state.mayDrive(strange, "Ann"));
});

test("only a ready and living player drives, and only in the battle", () => {
  const may = (game, me) => state.mayDrive(status({ game, users: [player("Ann", me)] }), "Ann");
  assert.ok(may(2, ready));
  assert.ok(!may(2, { ready: true, life: 0 }));
  assert.ok(!may(2, {}));
  assert.ok(!may(1, ready));
  assert.ok(!may(0, ready));
});

test("a pause is told to everybody, and nobody drives in it", () => {
  for (const game of [0, 1, 2]) {
    assert.equal(text({ game, paused: true, practice: true }, ready).text, "Paused by the operator");
    assert.ok(!state.mayDrive(status({ game, paused: true, practice: true, users: [player("Ann", ready)] }), "Ann"));
  }
  assert.equal(state.gameText(status({ game: 2, paused: true }), "Ann").text, "Looking for your robot...");
});

test("a screen reader hears the pause and its end", () => {
  const at = (paused) => status({ game: 2, paused, users: [player("Ann", ready)] });
  assert.match(state.announcement(at(false), at(true), "Ann"), /Paused by the operator/);
  assert.match(state.announcement(at(true), at(false), "Ann"), /PLAY!/);
  assert.equal(state.announcement(at(true), at(true), "Ann"), "");
});

test("the ready button toggles while the game stands still", () => {
  const button = (game, me) => state.readyButton(status({ game, users: [player("Ann", me)] }), "Ann");
  assert.deepEqual(button(0, {}), { ready: false, text: "Ready", hidden: false });
  assert.deepEqual(button(0, ready), { ready: true, text: "Ready!", hidden: false });
});

test("there is no ready button for the ready in the countdown, and for all in the battle", () => {
  const hidden = (game, me) => state.readyButton(status({ game, users: [player("Ann", me)] }), "Ann").hidden;
  assert.equal(hidden(1, {}), false);
  assert.equal(hidden(1, ready), true);
  assert.equal(hidden(2, {}), true);
  assert.equal(hidden(2, ready), true);
});

test("who is not in the battle may still join it where the server says so", () => {
  const late = (me) => status({ game: 2, users: [player("Ann", me), player("Bob", ready), player("Cy", { may_join: true })] });
  assert.deepEqual(state.readyButton(late({ may_join: true }), "Ann"), { ready: false, text: "Join in", hidden: false });
  assert.equal(state.readyButton(late(ready), "Ann").hidden, true);
  assert.equal(state.readyButton(late({ ready: true, life: 0 }), "Ann").hidden, true);
  assert.match(state.gameText(late({ may_join: true }), "Ann").hint, /^You can still join/);
  assert.equal(state.readyButton(late({}), "Ann").hidden, true, "another may, this one not");
  assert.equal(state.gameText(late({}), "Ann").hint, "You can join the next one.");
});

test("signs tell ready, out and not ready", () => {
  const sign = (user, game) => {
    const { symbol, meaning } = state.userSign(player("Bob", user), game);
    return [symbol, meaning];
  };
  assert.deepEqual(sign(ready, 0), ["play", "ready"]);
  assert.deepEqual(sign(ready, 2), ["play", "fighting"]);
  assert.deepEqual(sign({ ready: true, life: 0 }, 1), ["play", "ready"]);
  assert.deepEqual(sign({ ready: true, life: 0 }, 2), ["times", "out"]);
  assert.deepEqual(sign({ life: 0 }, 2), ["pause", "not ready"]);
  assert.deepEqual(sign({}, 0), ["pause", "not ready"]);
});

test("the list shows the others in the server's order", () => {
  const three = status({ users: [player("Bob"), player("Ann"), player("Eve")] });
  assert.deepEqual(state.others(three, "Ann").map((user) => user.name), ["Bob", "Eve"]);
});

const result = [
  player("Bob", { place: 1, life: 40, avatar: 3 }),
  player("Ann", { place: 2, life: 0 }),
  player("Zed", { place: 3, life: 70, left: true }),
];

const users = [player("Ann"), player("Bob")];
const playing = status({ game: 2, battle: 4, users });
const over = status({ battle: 4, users, result });

test("the end of a battle is told once", () => {
  assert.ok(state.hasEnded(playing, over, "Ann"));
  assert.ok(!state.hasEnded(over, over, "Ann"));
});

test("a result that was there before the page is no news", () => {
  assert.ok(!state.hasEnded(null, over, "Ann"));
  const heardByHttp = fromReply({ game: 0, timeLeft: 0, users: "[]" }, null);
  assert.ok(!state.hasEnded(heardByHttp, over, "Ann"));
});

test("a battle that ended while the connection was down is told when it is back", () => {
  const before = status({ battle: 3, users, result: [player("Ann", { place: 1 })] });
  assert.ok(state.hasEnded(before, over, "Ann"));
  const meanwhile = fromReply({ game: 0, timeLeft: 0, users: "[]" }, playing);
  assert.ok(state.hasEnded(meanwhile, over, "Ann"));
});

test("nobody is told the end of a battle that he has not played or has left", () => {
  assert.ok(!state.hasEnded(playing, over, "Eve"));
  assert.ok(!state.hasEnded(playing, over, "Zed"));
});

test("a stopped countdown is no end of a battle", () => {
  assert.ok(!state.hasEnded(status({ game: 1, users }), status({ users }), "Ann"));
});

test("life lost counts within a battle only", () => {
  const at = (game, life) => status({ game, users: [player("Ann", { ready: true, life })] });
  assert.equal(state.lifeLost(at(2, 100), at(2, 80), "Ann"), 20);
  assert.equal(state.lifeLost(at(2, 10), at(0, 0), "Ann"), 10, "the last hit ends the battle");
  assert.equal(state.lifeLost(at(1, 100), at(2, 100), "Ann"), 0);
  assert.equal(state.lifeLost(null, at(2, 80), "Ann"), 0);
  assert.equal(state.lifeLost(at(2, 0), at(1, 100), "Ann"), 0);
});

test("a screen reader hears changes and hits, not every second of the countdown", () => {
  const at = (game, time_left, life = 100) => status({ game, time_left, users: [player("Ann", { ready: true, life })] });
  assert.match(state.announcement(at(0, 0), at(1, 15), "Ann"), /15 sec to start/);
  assert.equal(state.announcement(at(1, 15), at(1, 14), "Ann"), "");
  assert.equal(state.announcement(at(2, 9), at(2, 9, 60), "Ann"), "Hit! Life 60 percent.");
  assert.match(state.announcement(at(2, 9, 10), at(2, 9, 0), "Ann"), /You are out/);
});

test("the clock shows minutes and seconds", () => {
  assert.equal(state.clockText(300), "5:00");
  assert.equal(state.clockText(64.2), "1:05");
  assert.equal(state.clockText(-1), "0:00");
});

test("the connection says what is wrong, the server before the robot", () => {
  assert.deepEqual([state.connectionState(true, true).level, state.connectionState(true, true).text], ["ok", "Online"]);
  assert.equal(state.connectionState(false, true).level, "warn");
  assert.match(state.connectionState(false, true).banner, /robot/);
  assert.equal(state.connectionState(true, false).level, "bad");
  assert.match(state.connectionState(false, false).banner, /server/);
  for (const web of [true, false]) assert.match(state.connectionState(false, web).text, /Reconnecting/);
});

test("who is not ready while others wait is warned in time", () => {
  const hint = (left) => state.gameText(status({ users: [player("al", { seat_left: left })] }), "al").hint;
  assert.match(hint(12.3), /in 13 s one of them gets your robot/);
  assert.doesNotMatch(hint(55), /gets your robot/);
  assert.doesNotMatch(hint(0), /gets your robot/);
});

test("where practice is allowed, one may drive without a battle, but not in a countdown or after death", () => {
  const drives = (values) => state.mayDrive(status({ practice: true, users: [player("al", { ready: true, life: 0 })], ...values }), "al");
  assert.deepEqual([drives({ game: 0 }), drives({ game: 1 }), drives({ game: 2 })], [true, false, false]);
  assert.equal(state.mayDrive(status({ practice: true }), "al"), false);
});

test("beside a battle of others one may drive where the rule says so", () => {
  const values = { game: 2, practice_beside: true };
  assert.ok(state.mayDrive(status({ ...values, users: [player("al")] }), "al"));
  assert.ok(!state.mayDrive(status({ ...values, users: [player("al", { ready: true, life: 0 })] }), "al"), "but not after death");
  assert.ok(!state.mayDrive(status({ ...values, game: 1, users: [player("al")] }), "al"), "nor in a countdown");
  assert.ok(!state.mayDrive(status({ ...values, paused: true, users: [player("al")] }), "al"));
  assert.ok(!state.mayDrive(status(values), "al"));
  assert.match(text(values).hint, /you can drive; your laser is off/);
});

test("at the edge of the floor the player hears why the robot stands still, in practice, too", () => {
  const hint = (values, me) => state.gameText(status({ ...values, users: [player("al", me)] }), "al").hint;
  assert.match(hint({ game: 2 }, { ready: true, fence: 1 }), /stopped at the edge: turn/);
  assert.match(hint({ game: 0, practice: true }, { fence: 2 }), /stopped at the edge: turn/);
  assert.doesNotMatch(hint({ game: 2 }, { ready: true, fence: 0 }), /edge/);
  assert.doesNotMatch(hint({ game: 2 }, { ready: true, life: 0, fence: 1 }), /edge/);
});

test("a player sees what a pick-up does and for how long the hill was held", () => {
  const hint = (me) => state.gameText(status({ game: 2, users: [player("al", { ready: true, ...me })] }), "al").hint;
  assert.equal(hint({ effects: 1 }), "Shield: no hit counts.");
  assert.equal(hint({ effects: 3, points: 7 }), "Shield: no hit counts. Double damage! Hill: 7 s");
  assert.doesNotMatch(hint({}), /Hill|Shield|Double/);
});

test("light goes out in one's own battle and in practice before it, but not beside a battle of others", () => {
  const shoots = (values, me) => state.mayShoot(status({ ...values, users: [player("al", me)] }), "al");
  assert.ok(shoots({ game: 2, practice_beside: true }, { ready: true }));
  assert.ok(shoots({ game: 0, practice: true }));
  assert.ok(!shoots({ game: 2, practice_beside: true }));
  assert.ok(!shoots({ game: 2, practice_beside: true }, { ready: true, life: 0 }));
});

test("screen readers hear who has hit whom, as far as the light tells", () => {
  const fight = (ann, bob, events) => status({ game: 2, battle: 1, users: [player("Ann", { ready: true, life: ann }), player("Bob", { ready: true, life: bob })], events });
  const said = (...states) => state.announcement(...states, "Ann");
  const start = fight(100, 100, []);
  assert.equal(said(start, fight(90, 100, [hit(1, "Bob", "Ann", 90)])), "Hit by Bob! Life 90 percent.");
  assert.equal(said(start, fight(90, 100, [hit(1, "", "Ann", 90)])), "Hit! Life 90 percent.");
  assert.equal(said(start, fight(100, 80, [hit(1, "Ann", "Bob", 80)])), "You hit Bob: 80 percent left.");
  assert.equal(said(start, fight(100, 0, [hit(1, "Ann", "Bob", 0)])), "Bob is out!");
  assert.match(said(start, fight(0, 100, [hit(1, "Bob", "Ann", 0)])), /^Bob took you out! You are out: watch/);
});

test("who fights for a team reads for which one", () => {
  assert.equal(text({ game: 2, teams: 2 }, { ready: true, team: 2 }).hint, "You fight for team Blue: hit the others, dodge their lasers.");
});
