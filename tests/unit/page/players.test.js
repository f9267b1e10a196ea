import assert from "node:assert/strict";
import { test } from "node:test";
import { arenaPlayers } from "../../../server/static/js/battle/players.js";
import { player, status } from "./samples.js";

globalThis.PICTURES = { "img/avatar0.svg": "avatar0-12AB34CD.svg" };

const shown = (game, me) => arenaPlayers(status({ game, users: [player("Ann", me)] }), "Ann");

test("the arena hears who drives which robot, with which picture and pick-ups", () => {
  assert.deepEqual(shown(1, { robot: 3, ready: true, effects: 2 }), {
    me: "Ann",
    phase: "countdown",
    players: [{ name: "Ann", robot: 3, life: 100, ready: true, out: false, avatar: "/static/avatar0-12AB34CD.svg", colour: null, shield: false, doubleDamage: true }],
  });
});

test("a team's robots have its colour in the arena", () => {
  const colours = [1, 2, 3, 4, 1].map((team) => shown(2, { team, ready: true }).players[0].colour);
  assert.ok(colours.every((colour) => /^#[0-9a-f]{6}$/.test(colour)));
  assert.equal(new Set(colours).size, 4);
});

test("only who has fought is out", () => {
  const out = (game, me) => shown(game, me).players[0].out;
  assert.deepEqual([out(2, { ready: true, life: 0 }), out(2, { life: 0 }), out(0, { ready: true, life: 0 })], [true, false, false]);
});
