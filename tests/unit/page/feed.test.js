import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { test } from "node:test";
import { changes } from "../../../server/static/js/feed.js";
import { feedEntry } from "../../../server/static/js/feed_words.js";
import { fromReply } from "../../../server/static/js/messages.js";
import { COUNTDOWN, PLAYING, STOPPED } from "../../../server/static/js/state.js";
import { setWords } from "../../../server/static/js/words.js";
import { player, status } from "./samples.js";

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
  assert.deepEqual(changes(empty, here), [{ kind: "joined", name: "Al", avatar: 3, life: 100, robot: 2, winners: [] }]);
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
  const kinds = ["joined", "left", "ready", "unready", "countdown", "cancelled", "start", "hit", "out", "aborted", "paused", "resumed"];
  for (const language of ["en", "it", "de"]) {
    const words = JSON.parse(readFileSync(new URL(`../../../server/static/words/${language}.json`, import.meta.url)));
    setWords(words, language);
    for (const kind of kinds) {
      const { text, avatar } = feedEntry({ kind, name: user.name, avatar: user.avatar, life: user.life, winners: [] });
      assert.equal(avatar, 2);
      assert.doesNotMatch(text, /[{}]|undefined/);
    }
    const hit = feedEntry({ kind: "hit", name: "Al", avatar: 2, life: 40, winners: [] });
    assert.match(hit.text, /Al.*40\s?%/u);
    assert.equal(hit.tone, "hit");
    const end = (...winners) => feedEntry({ kind: "end", name: "", avatar: null, life: null, winners }).text;
    assert.match(end("Al"), /Al/);
    assert.match(end("Al", "Bo"), /Al.*Bo/);
    assert.equal(new Set([end(), end("Al"), end("Al", "Bo")]).size, 3);
  }
});
