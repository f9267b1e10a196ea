import assert from "node:assert/strict";
import { test } from "node:test";
import { OwnTournament } from "../../../server/static/js/battle/own_tournament.js";
import { championText, matchText, nextMatches, ownText } from "../../../server/static/js/battle/tournament.js";
import { TournamentFeed } from "../../../server/static/js/battle/tournament_feed.js";
import { status } from "./samples.js";

const seeds = (one, other) => [one, other].map((number) => ({ what: "seed", number, place: null }));

function match(number, players, values = {}) {
  return { number, players, sources: seeds(1, 2), wins: [0, 0], winner: null, called: false, robots: null, seconds: 180 * number, ...values };
}

const winners = [{ what: "winner", number: 1, place: null }, { what: "winner", number: 2, place: null }];
const tournament = (...matches) => ({ open: true, version: 3, champion: null, matches });
const final = match(3, ["ada", null], { sources: winners });

test("a player learns against whom, when, and with which robot", () => {
  const waits = tournament(match(1, ["ada", "dee"], { seconds: 360 }), match(2, ["bob", "cy"], { seconds: 180 }));
  assert.equal(ownText(waits, "dee"), "Match 1: you play against ada in about 6 minutes.");
  const called = tournament(match(1, ["ada", "dee"], { called: true, robots: [2, 5], seconds: 0 }), match(2, ["bob", "cy"]));
  assert.equal(ownText(called, "DEE"), "Match 1: you play against ada now, with robot 5. Press Ready!");
  assert.match(ownText(called, "bob"), /Match 2: you play against cy/);
  assert.match(ownText(called, "eve"), /Match 1 of the tournament: ada against dee/);
});

test("a name is the same however it is written, as for the server", () => {
  const called = tournament(match(1, ["Strauß", "Ｄee"], { called: true, robots: [2, 5], seconds: 0 }));
  assert.match(ownText(called, "STRAUSS"), /with robot 2/);
  assert.match(ownText(called, "dee"), /with robot 5/);
});

test("a player whose opponent is not known yet learns where that one comes from", () => {
  assert.equal(ownText(tournament(final), "ada"), "Match 3: you play in about 9 minutes, against the winner of match 2.");
});

test("whoever does not play any more, and everybody without a tournament, is told nothing", () => {
  assert.equal(ownText(tournament(match(1, ["ada", "dee"], { winner: "ada" }), final), "dee"), "");
  assert.equal(ownText({ ...tournament(final), open: false }, "ada"), "");
  assert.equal(ownText(null, "ada"), "");
});

test("the hall has the next matches, the one that is called first", () => {
  const called = match(2, ["bob", "cy"], { called: true, robots: [0, 1], seconds: 0 });
  const next = nextMatches(tournament(match(1, ["ada", "dee"]), called, final), 2);
  assert.deepEqual(next.map(({ number }) => number), [2, 1]);
  assert.equal(matchText(next[0]), "Match 2: now: bob with robot 0, cy with robot 1");
  assert.equal(matchText(next[1]), "Match 1: ada against dee, in about 3 minutes");
  assert.equal(championText({ champion: "ada" }), "ada has won the tournament!");
});

/** A world whose answers the test gives, and whose time it passes. */
function world(...answers) {
  const later = [];
  return { asked: 0, later: (ms, act) => later.push(act), pass: () => later.shift()(), random: () => 0.5, left: later, ask() { this.asked += 1; return Promise.resolve(answers.shift() ?? null); } };
}
const settled = () => new Promise((resolve) => setImmediate(resolve));

test("nothing is asked while no tournament is open", async () => {
  const asked = world();
  new TournamentFeed(() => assert.fail("there is none"), asked).take({ tournament: 0 });
  await settled();
  assert.equal(asked.asked, 0);
});

test("a change is asked for once, and again until the database has it", async () => {
  const shown = [];
  const asked = world({ version: 4, open: true }, { version: 5, open: true });
  const feed = new TournamentFeed((found) => shown.push(found?.version ?? null), asked);
  feed.take({ tournament: 5 });
  feed.take({ tournament: 5 });
  await settled();
  assert.deepEqual(shown, [4]);
  asked.pass();
  await settled();
  assert.deepEqual([shown, asked.asked, asked.left.length], [[4, 5], 2, 0]);
  feed.take({ tournament: 0 });
  assert.deepEqual(shown, [4, 5, null]);
});

test("what changes while an answer is under way is asked for, too", async () => {
  const shown = [];
  const asked = world({ version: 5, open: true }, { version: 6, open: true });
  const feed = new TournamentFeed((found) => shown.push(found.version), asked);
  feed.take({ tournament: 5 });
  feed.take({ tournament: 6 });
  await settled();
  asked.pass();
  await settled();
  assert.deepEqual(shown, [5, 6]);
});

test("a player's card is out of the way in a countdown and a battle", async () => {
  const box = { hidden: true, textContent: "" };
  const own = new OwnTournament("ada", box, world({ ...tournament(match(1, ["ada", "dee"])), version: 1 }));
  own.take(status({ tournament: 1 }));
  await settled();
  const shown = [0, 1, 2, 0].map((game) => {
    own.take(status({ tournament: 1, game }));
    return !box.hidden;
  });
  assert.deepEqual(shown, [true, false, false, true]);
  assert.match(box.textContent, /you play against dee/);
  own.take(status({ tournament: 0 }));
  assert.equal(box.hidden, true);
});

test("a server that does not answer is asked again", async () => {
  const shown = [];
  const asked = world(null, { version: 2, open: true });
  new TournamentFeed((found) => shown.push(found.version), asked).take({ tournament: 2 });
  await settled();
  asked.pass();
  await settled();
  assert.deepEqual(shown, [2]);
});
