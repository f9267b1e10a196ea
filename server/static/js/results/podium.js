// The result of a battle as a podium.

import { avatarUrl } from "../common/assets.js";
import { element } from "../common/dom.js";
import { wearColour } from "../common/robot_colours.js";
import { makeMark, showMark } from "../battle/team_view.js";
import { standings } from "../battle/teams.js";
import { percent, t } from "../common/words.js";

/** @typedef {import("../battle/messages.js").Player} Player */

const METALS = ["gold", "silver", "bronze"];

/**
 * Who stands on which step, teams as one. Ties share one, and the place after them stays empty; whoever left early
 * stands on none.
 * @param {Player[]} result best first
 * @returns {{steps: {metal: "gold"|"silver"|"bronze", place: number, players: Player[]}[], rest: Player[]}}
 */
export function podium(result) {
  const placed = standings(result);
  const steps = METALS.map((metal, index) => {
    const place = index + 1;
    return { metal, place, players: placed.filter((entry) => entry.place === place && !entry.left) };
  }).filter((step) => step.players.length > 0);
  const honoured = new Set(steps.flatMap((step) => step.players));
  return { steps, rest: placed.filter((entry) => !honoured.has(entry)) };
}

/**
 * The podium and, below it, everybody else.
 * @param {Player[]} result best first
 * @param {string|null} me this page's player
 * @param {boolean} coded whether the light has told who has shot
 */
export function podiumView(result, me, coded) {
  const { steps, rest } = podium(result);
  return element(
    "div",
    { className: "podium" },
    element("ol", { className: "podium-steps" }, ...steps.map((step) => stepView(step, me, coded))),
    rest.length > 0 && restView(rest, me, coded),
  );
}

function stepView({ metal, place, players }, me, coded) {
  const { team } = players[0];
  const crowd = element("div", { className: "podium-crowd" }, ...players.map((player) => honouredView(player, me, coded)));
  const block = element(
    "div",
    { className: "podium-block" },
    element("span", { className: "visually-hidden" }, `${t(`podium.${metal}`)}, `),
    element("span", {}, String(place)),
  );
  const step = element("li", { className: "podium-step", value: place }, block, crowd, team > 0 && markOf(players[0]));
  step.dataset.metal = metal;
  step.dataset.crowd = team > 0 ? "team" : players.length > 2 ? "many" : "few";
  return step;
}

function honouredView(player, me, coded) {
  return element(
    "figure",
    { className: player.name === me ? "podium-player is-me" : "podium-player" },
    pictureOf(player, 96),
    element(
      "figcaption",
      {},
      element("strong", { title: player.name }, player.name),
      player.name === me && element("em", {}, t("podium.you")),
      ...notesOf(player, coded).map((note) => element("span", { className: "podium-note" }, note)),
    ),
  );
}

function restView(rest, me, coded) {
  const rows = rest.map((player) =>
    element(
      "li",
      { className: player.name === me ? "is-me" : "", value: player.place },
      element("span", { className: "podium-place" }, String(player.place)),
      pictureOf(player, 32),
      element("strong", { title: player.name }, player.name),
      player.name === me && element("em", {}, t("podium.you")),
      markOf(player),
      element("span", { className: "podium-note" }, notesOf(player, coded).join(", ")),
    ),
  );
  const list = element("ol", { className: "podium-rest" }, ...rows);
  list.setAttribute("aria-label", t("podium.rest"));
  return list;
}

/** What there is to say about a player: hits and opponents taken out, if the light has told them. */
function notesOf({ left, life, shots, hits, kills, points = 0, wins }, coded) {
  const end = left ? t("podium.left") : t("podium.life", { life: percent(life) });
  return [wins > 1 && t("podium.wins", { n: wins }), end, points > 0 && t("game.hill", { n: points }), coded && shots > 0 && t("podium.shots", { hits, shots }), coded && kills > 0 && t("podium.kills", { n: kills })].filter(Boolean);
}

function pictureOf({ avatar, robot }, size) {
  const picture = element("img", { src: avatarUrl(avatar), alt: "", width: size, height: size });
  wearColour(picture, robot);
  return picture;
}

function markOf({ team }) {
  const mark = makeMark();
  showMark(mark, team, true);
  return mark;
}
