import assert from "node:assert/strict";
import { test } from "node:test";
import { isGame, readPlayers } from "../../../sim/static/players.js";

const PAGE = "http://hall.local:5000";
const AL = { name: "Al", robot: 3, avatar: "/static/a.svg", life: 70, out: false, ready: true };
const said = (fields) => readPlayers({ type: "laserbot-players", me: null, players: [AL], ...fields }, PAGE);

test("only pages at the arena's own host name belong to the game, on any port, by http or https", () => {
  for (const origin of ["http://hall.local:5000", "https://hall.local", "http://hall.local:1"]) {
    assert.equal(isGame(origin, "hall.local"), true, origin);
  }
  for (const origin of ["http://evil.example", "http://hall.local.evil.example", "http://xhall.local", "ftp://hall.local", "null", "", "hall.local"]) {
    assert.equal(isGame(origin, "hall.local"), false, origin);
  }
  assert.equal(isGame("http://[::1]:5000", "[::1]"), true);
});

test("a message tells who plays, who looks and what the words are", () => {
  const players = said({ me: "Al", phase: "playing", labels: { you: "TU" }, effects: "reduced", scale: 0.5 });
  assert.deepEqual(players, {
    me: "Al",
    phase: "playing",
    effects: "reduced",
    scale: 0.5,
    labels: { you: "TU" },
    players: [{ ...AL, avatar: "http://hall.local:5000/static/a.svg", colour: null }],
  });
});

test("what is not such a message is nothing", () => {
  for (const data of [null, undefined, "laserbot-players", 7, {}, { type: "laserbot-players" }, { type: "other", players: [] }, { type: "laserbot-players", players: "Al" }]) {
    assert.equal(readPlayers(data, PAGE), null);
  }
});

test("a picture is the page's own or none", () => {
  const avatarOf = (avatar) => said({ players: [{ ...AL, avatar }] }).players[0].avatar;
  assert.equal(avatarOf("http://hall.local:5000/b.png"), "http://hall.local:5000/b.png");
  const strange = [
    "http://evil.example/x.png", "//evil.example/x.png", "http://hall.local:8080/x.png", "https://hall.local:5000/x.png",
    "data:image/png;base64,AA==", "javascript:alert(1)", "http://u:p@hall.local:5000/x", "http://[", `/${"x".repeat(600)}`, 5, null, {},
  ];
  for (const avatar of strange) assert.equal(avatarOf(avatar), null, String(avatar));
});

test("players without a name or a robot are left out, wrong values of the others are mended", () => {
  const wrong = [null, 5, "Al", {}, { name: "", robot: 1 }, { name: "x".repeat(33), robot: 1 }, { name: "Al" }, { name: "Al", robot: -1 }, { name: "Al", robot: 1.5 }, { name: "Al", robot: 128 }, { name: 5, robot: 1 }];
  assert.deepEqual(said({ players: wrong }).players, []);
  const lifeOf = (life) => said({ players: [{ ...AL, life }] }).players[0].life;
  assert.deepEqual([-5, 0, 49.6, 100, 1e9].map(lifeOf), [0, 0, 50, 100, 100]);
  for (const life of [NaN, Infinity, "70", null, undefined]) assert.equal(lifeOf(life), 100);
  const odd = said({ players: [{ ...AL, out: 1, ready: "yes", colour: "red" }] }).players[0];
  assert.deepEqual([odd.out, odd.ready, odd.colour], [false, false, null]);
  assert.equal(said({ players: [{ ...AL, colour: "#12aBcD" }] }).players[0].colour, "#12aBcD");
});

test("the other fields are bounded too", () => {
  const odd = said({ me: "x".repeat(33), phase: "Playing!", effects: "all", labels: { you: "x".repeat(17), hit: 5, empty: "Nessuno", evil: "x" } });
  assert.deepEqual([odd.me, odd.phase, odd.effects, odd.labels], [null, "", "auto", { empty: "Nessuno" }]);
  for (const [scale, read] of [[undefined, 1], ["0.5", 1], [NaN, 1], [-1, 0.1], [0.25, 0.25], [7, 1]]) assert.equal(said({ scale }).scale, read);
  for (const labels of [null, 5, "you", []]) assert.deepEqual(said({ labels }).labels, {});
});

test("64 players at most, and one for each robot", () => {
  const crowd = Array.from({ length: 100 }, (_, robot) => ({ ...AL, name: `p${robot}`, robot }));
  assert.equal(said({ players: crowd }).players.length, 64);
  assert.deepEqual(said({ players: [AL, { ...AL, name: "Bo" }] }).players.map(({ name }) => name), ["Al"]);
});
