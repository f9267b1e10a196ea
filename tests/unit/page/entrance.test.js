import assert from "node:assert/strict";
import { test } from "node:test";
import { arenaUrl, countsText, problemText, stateText, summaryText } from "../../../server/static/js/entrance/arenas.js";
import "./samples.js";

const arena = (fields) => ({ name: "red", address: ":30510", state: "stopped", free: 0, players: 0, waiting: 0, ...fields });
const AWAY = { name: "blue", address: ":30520", state: "away" };

test("an arena is at a port of the entrance's host, or at an address of its own", () => {
  assert.equal(arenaUrl(":30510", "10.0.0.7"), "http://10.0.0.7:30510");
  assert.equal(arenaUrl("https://red.example", "10.0.0.7"), "https://red.example");
});

test("the free robots of all arenas are counted, but for those that are away", () => {
  assert.equal(summaryText([arena({ free: 2 }), arena({ free: 1 }), AWAY]), "3 robots are free");
});

test("where no robot is free, it is told who waits", () => {
  assert.equal(summaryText([arena({ waiting: 1 }), arena({ waiting: 2 })]), "No robot is free: 3 players are waiting");
});

test("without any arena there is nothing to wait for", () => {
  assert.match(summaryText([AWAY]), /No arena answers/);
  assert.match(summaryText([]), /No arena answers/);
});

test("an arena is open while it has a robot", () => {
  assert.equal(stateText(arena({ free: 1 })), "open");
  assert.equal(stateText(arena({})), "full");
  assert.equal(stateText(arena({ state: "playing", free: 1 })), "battle");
  assert.equal(stateText(AWAY), "away");
});

test("who waits is told only where somebody does", () => {
  assert.equal(countsText(arena({ free: 1, players: 2 })), "1 robot is free · 2 players");
  assert.equal(countsText(arena({ players: 2, waiting: 1 })), "0 robots are free · 2 players · 1 waits");
  assert.equal(countsText(AWAY), "This arena does not answer.");
});

test("each refusal says what to do, an unknown one too", () => {
  for (const status of ["BAD_NAME", "RESERVED_NAME", "NO_ARENAS", "TOO_FAST", "HTTP 502"]) assert.ok(problemText(status).length > 10);
});
