import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { test } from "node:test";
import { changes } from "../../../server/static/js/battle/feed.js";
import { feedEntry } from "../../../server/static/js/battle/feed_words.js";
import { newHits } from "../../../server/static/js/battle/hits.js";
import { fromReply } from "../../../server/static/js/battle/messages.js";
import { COUNTDOWN, PLAYING, STOPPED } from "../../../server/static/js/battle/state.js";
import { setWords } from "../../../server/static/js/common/words.js";
import { hit, player, status } from "./samples.js";

const fighters = (...lives) => lives.map((life, index) => player(["Al", "Bo", "Cy"][index], { ready: true, life, robot: index }));
const placings = (...lives) =>
  lives.map((life, index) => player(["Al", "Bo", "Cy"][index], { life, robot: index, place: index + 1 }));
const battle = (lives, values = {}) => status({ game: PLAYING, battle: 4, users: fighters(...lives), ...values });

/** "kind name life" of each change. */
const told = (previous, current) =>
  changes(previous, current).map(({ kind, name, life }) => [kind, name, kind === "hit" ? life : ""].filter((word) => word !== "").join(" "));

test("the first state is no news, and the same state again neither", () => {
  const now = battle([100, 50]);
  assert.deepEqual(changes(null, now), []);
  assert.deepEqual(changes(now, now), []);
});

test("who comes, gets ready, changes the mind and goes is told", () => {
  const empty = status();
  const here = status({ users: [player("Al", { avatar: 3, robot: 2 })] });
  const ready = status({ users: [player("Al", { avatar: 3, robot: 2, ready: true })] });
  assert.deepEqual(changes(empty, here), [{ kind: "joined", name: "Al", avatar: 3, life: 100, robot: 2, by: null, winners: [], teams: [] }]);
  assert.deepEqual(told(here, ready), ["ready Al"]);
  assert.deepEqual(told(ready, here), ["unready Al"]);
  assert.deepEqual(told(here, empty), ["left Al"]);
});

test("a battle is told from its countdown to its end", () => {
  const idle = status({ battle: 3, users: [player("Al"), player("Bo")] });
  const countdown = status({ game: COUNTDOWN, battle: 3, users: fighters(100, 100) });
  assert.deepEqual(told(idle, countdown), ["ready Al", "ready Bo", "countdown"]);
  assert.deepEqual(told(countdown, battle([100, 100])), ["start"]);
  assert.deepEqual(told(battle([100, 100]), battle([100, 80])), ["hit Bo 80"]);
  assert.deepEqual(told(battle([100, 80]), battle([90, 0])), ["hit Al 90", "out Bo"]);
  const over = status({ game: STOPPED, battle: 4, users: [player("Al"), player("Bo")], result: placings(90, 0) });
  assert.deepEqual(told(battle([90, 10]), over), ["out Bo", "end"]);
  assert.deepEqual(changes(battle([90, 10]), over).at(-1).winners, ["Al"]);
});

test("who is in no battle, or has left it, is hit by nothing", () => {
  const withGuest = (life) => battle([100], { users: [...fighters(100), player("Di", { life })] });
  assert.deepEqual(told(withGuest(100), withGuest(30)), []);
  const over = status({ battle: 4, users: [player("Al")], result: [...placings(100), player("Bo", { life: 20, place: 2, left: true })] });
  assert.deepEqual(told(battle([100, 50]), over), ["left Bo", "end"]);
});

test("lives that begin anew are no news, and hits of a new battle count from the full life", () => {
  const last = status({ game: PLAYING, battle: 4, users: fighters(100, 10) });
  assert.deepEqual(told(last, status({ game: COUNTDOWN, battle: 4, users: fighters(100, 100) })), ["countdown"]);
  assert.deepEqual(told(last, battle([100, 90], { battle: 5 })), ["start", "hit Bo 90"]);
});

test("a battle that was missed wholly is told by its end", () => {
  const before = status({ battle: 3, users: [player("Al"), player("Bo")], result: placings(10, 0) });
  const after = status({ battle: 4, users: [player("Al"), player("Bo")], result: placings(60, 0) });
  assert.deepEqual(told(before, after), ["hit Al 60", "out Bo", "end"]);
});

test("shared first places are all told, and who left early never", () => {
  const result = [player("Al", { place: 1 }), player("Bo", { place: 1 }), player("Cy", { place: 1, left: true })];
  const end = changes(battle([100, 100]), status({ battle: 4, result, users: fighters() })).at(-1);
  assert.deepEqual(end.winners, ["Al", "Bo"]);
});

test("pause, a countdown that stops and a battle that does not count are told", () => {
  const countdown = (values) => status({ game: COUNTDOWN, users: fighters(100, 100), ...values });
  assert.deepEqual(told(countdown(), countdown({ paused: true })), ["paused"]);
  assert.deepEqual(told(countdown({ paused: true }), countdown()), ["resumed"]);
  assert.deepEqual(told(countdown(), status({ users: fighters(100, 100) })), ["cancelled"]);
  const aborted = status({ battle: 4, notice: "Battle over: the operator has ended it.", users: [player("Al")] });
  assert.deepEqual(told(battle([100]), aborted), ["aborted"]);
});

test("by HTTP alone, the end waits for the result", () => {
  const running = battle([100, 50]);
  const stopped = fromReply({ game: 0, timeLeft: 0, users: JSON.stringify([{ name: "Al", life: 100, ready: 0, robot: 0 }, { name: "Bo", life: 50, ready: 0, robot: 1 }]) }, running);
  assert.deepEqual(told(running, stopped), []);
  const result = status({ battle: 4, users: stopped.users, result: placings(100, 50) });
  assert.deepEqual(told(stopped, result), ["end"]);
});

test("each change has words in each language", () => {
  const user = player("Al", { life: 40, avatar: 2 });
  const kinds = ["joined", "left", "ready", "unready", "countdown", "cancelled", "start", "hit", "out", "aborted", "paused", "resumed",
    "fenced", "hill", "repair", "shield", "double_damage"];
  for (const language of ["en", "it", "de"]) {
    const words = JSON.parse(readFileSync(new URL(`../../../server/static/words/${language}.json`, import.meta.url)));
    setWords(words, language);
    for (const kind of kinds) {
      const { text, avatar, victim } = feedEntry({ kind, name: user.name, avatar: user.avatar, life: user.life, by: null, winners: [], teams: [] });
      assert.deepEqual([avatar, victim], [2, null]);
      assert.doesNotMatch(text, /[{}]|undefined/);
    }
    const hurt = { name: "Al", avatar: 2, life: 40, by: null, winners: [], teams: [] };
    assert.match(feedEntry({ kind: "hit", ...hurt }).text, /Al.*40\s?%/u);
    assert.equal(feedEntry({ kind: "hit", ...hurt }).tone, "hit");
    for (const kind of ["hit", "out", "refused"]) {
      const { text, avatar, victim } = feedEntry({ kind, ...hurt, by: { name: "Bo", avatar: 4, streak: 1, revenge: false } });
      assert.match(text, /Bo.*Al/);
      assert.doesNotMatch(text, /[{}]/);
      assert.deepEqual([avatar, victim], [4, 2]);
    }
    const takenOut = (by) => feedEntry({ kind: "out", ...hurt, by: { name: "Bo", avatar: 4, streak: 1, revenge: false, ...by } }).text;
    assert.match(takenOut({ streak: 3 }), /Bo.*Al.*3/);
    const texts = [takenOut({}), takenOut({ streak: 2 }), takenOut({ streak: 2, revenge: true })];
    assert.equal(new Set(texts).size, 3);
    const ended = (values) => feedEntry({ kind: "end", name: "", avatar: null, life: null, by: null, winners: [], teams: [], ...values }).text;
    const end = (...winners) => ended({ winners });
    assert.match(ended({ winners: ["Al", "Bo"], teams: [2] }), new RegExp(words.teams.team2));
    assert.match(ended({ winners: ["Al", "Bo"], teams: [2, 4] }), new RegExp(`${words.teams.team2}.*${words.teams.team4}`));
    assert.match(end("Al"), /Al/);
    assert.match(end("Al", "Bo"), /Al.*Bo/);
    assert.equal(new Set([end(), end("Al"), end("Al", "Bo")]).size, 3);
  }
});

/** "by kind name life" of each change. */
const toldBy = (previous, current) =>
  changes(previous, current).map(({ kind, name, life, by }) => [by?.name, kind, name, life].filter((word) => word !== undefined && word !== null && word !== "").join(" "));

test("where the referee tells who has shot, the feed does, with both pictures", () => {
  const users = (life) => [player("Al", { ready: true, avatar: 3 }), player("Bo", { ready: true, robot: 1, avatar: 1, life })];
  const before = status({ game: PLAYING, battle: 4, users: users(100), events: [] });
  const after = status({ game: PLAYING, battle: 4, users: users(80), events: [hit(7, "Al", "Bo", 90), hit(8, "Al", "Bo", 80)] });
  assert.deepEqual(toldBy(before, after), ["Al hit Bo 90", "Al hit Bo 80"]);
  const [first] = changes(before, after);
  assert.deepEqual([first.avatar, first.robot, first.by], [1, 1, { name: "Al", avatar: 3, streak: 0, revenge: false }]);
  assert.deepEqual(changes(after, after), []);
});

test("a hit that is refused is told as such, and is none to anybody else", () => {
  const before = battle([100, 90], { events: [hit(7, "Al", "Bo", 90)] });
  const after = battle([100, 90], { events: [hit(7, "Al", "Bo", 90), { ...hit(8, "Al", "Bo", 90), kind: 2 }] });
  assert.deepEqual(toldBy(before, after), ["Al refused Bo 90"]);
  assert.deepEqual(newHits(before, after), []);
});

test("a hit of which the light does not tell the shooter is told as before", () => {
  const after = battle([100, 90], { events: [hit(7, "", "Bo", 90)] });
  assert.deepEqual(toldBy(battle([100, 100], { events: [] }), after), ["hit Bo 90"]);
});

test("more hits than the state can hold are told by what is left of the lives", () => {
  const events = [hit(20, "Al", "Bo", 10), hit(21, "Al", "Bo", 0)];
  assert.deepEqual(toldBy(battle([100, 100, 100], { events: [] }), battle([100, 0, 40], { events })), ["Al hit Bo 10", "Al out Bo 0", "hit Cy 40"]);
});

test("who was shot and has left the page is told once, and so is the end", () => {
  const events = [hit(3, "Al", "Bo", 0)];
  const before = battle([100, 10], { events: [] });
  const over = status({ battle: 4, users: [player("Al")], result: placings(100, 0), events });
  assert.deepEqual(toldBy(before, over), ["left Bo 10", "Al out Bo 0", "end"]);
  assert.deepEqual(toldBy(over, { ...over }), []);
});

test("the end of a battle of teams names the teams that have won", () => {
  const team = (name, number, place) => player(name, { team: number, place });
  const end = (...result) => changes(battle([100, 100]), status({ battle: 4, users: fighters(), result, teams: 2 })).at(-1);
  assert.deepEqual(end(team("Al", 2, 1), team("Cy", 2, 1), team("Bo", 1, 3)).teams, [2]);
  assert.deepEqual(end(team("Al", 2, 1), team("Bo", 1, 1)).teams, [2, 1]);
});
