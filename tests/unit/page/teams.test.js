import assert from "node:assert/strict";
import { test } from "node:test";
import { outcomeOf } from "../../../server/static/js/game/result.js";
import { teamChoice } from "../../../server/static/js/battle/state.js";
import { byTeam, standings, teamsOf } from "../../../server/static/js/battle/teams.js";
import { player, status } from "./samples.js";

const entry = (name, team, place, values = {}) => player(name, { team, place, ...values });
const RESULT = [entry("Ann", 2, 1), entry("Cy", 2, 1, { life: 0 }), entry("Bob", 1, 3), entry("Di", 1, 3), entry("Eve", 3, 5)];

test("the places of a battle of teams are the teams' own", () => {
  assert.deepEqual(standings(RESULT).map(({ name, place }) => `${name} ${place}`), ["Ann 1", "Cy 1", "Bob 2", "Di 2", "Eve 3"]);
  assert.deepEqual(teamsOf(RESULT), [2, 1, 3]);
});

test("who has left alive stands behind all teams", () => {
  const left = [entry("Ann", 1, 1), entry("Bob", 2, 2), entry("Cy", 2, 3, { left: true })];
  assert.deepEqual(standings(left).map(({ place }) => place), [1, 2, 3]);
});

test("without teams, the places stay", () => {
  const alone = [player("Ann", { place: 1 }), player("Bob", { place: 1 }), player("Cy", { place: 3 })];
  assert.equal(standings(alone), alone);
  assert.deepEqual(teamsOf(alone), []);
});

test("a team wins together, and who has lost reads which one and where the own one is", () => {
  assert.deepEqual(outcomeOf(RESULT, "Cy"), { outcome: "win", title: "YOU WIN!", text: "Team Blue wins!" });
  assert.deepEqual(outcomeOf(RESULT, "Di"), { outcome: "lose", title: "YOU LOST!", text: "Team Blue wins! Your team, Red, came in at number 2." });
});

test("teams that share the first place have a draw", () => {
  const draw = [entry("Ann", 1, 1), entry("Bob", 2, 1), entry("Cy", 3, 3)];
  assert.deepEqual(outcomeOf(draw, "Bob"), { outcome: "draw", title: "DRAW!", text: "A draw: Red and Blue." });
  assert.equal(outcomeOf(draw, "Cy").text, "A draw: Red and Blue. Your team, Green, came in at number 2.");
});

test("a lobby shows the teams in their order, then who leaves it to the referee", () => {
  const users = [player("Ann"), player("Bob", { team: 2 }), player("Cy", { team: 1 }), player("Di", { team: 2 })];
  assert.deepEqual(byTeam(users).map(({ name }) => name), ["Cy", "Bob", "Di", "Ann"]);
});

test("a team is chosen before the battle, if there are teams", () => {
  const choice = (values, me = {}) => teamChoice(status({ teams: 3, users: [player("Ann", { team: 2, ...me })], ...values }), "Ann");
  assert.deepEqual([choice().teams, choice().own], [3, 2]);
  assert.notEqual(choice({}, { ready: true }), null);
  assert.notEqual(choice({ game: 1 }), null);
  assert.equal(choice({ game: 1 }, { ready: true }), null, "the fingers are on the controls");
  assert.equal(choice({ game: 2 }), null);
  assert.equal(choice({ teams: 0 }), null);
});
