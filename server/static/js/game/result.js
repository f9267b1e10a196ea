// The end of a battle for one who has fought in it: the podium, what this player did, and what comes next.

import * as dialogs from "../common/dialogs.js";
import { element } from "../common/dom.js";
import { podiumView } from "../results/podium.js";
import { pictureButtons } from "./result_picture.js";
import { clockText } from "../battle/state.js";
import { standings, teamName, teamsOf } from "../battle/teams.js";
import { list, percent, t } from "../common/words.js";

/**
 * How it went for `name`. Pure.
 * @param {import("../battle/messages.js").Player[]} result
 * @returns {{outcome: "win"|"draw"|"lose", title: string, text: string}}
 */
export function outcomeOf(result, name) {
  const { place, team } = result.find((entry) => entry.name === name);
  if (team > 0) return outcomeOfTeam(standings(result), name);
  const tied = result.some((entry) => entry.name !== name && entry.place === place);
  const outcome = place > 1 ? "lose" : tied ? "draw" : "win";
  return { outcome, title: t(`result.${outcome}`), text: t(tied ? "result.shared" : "result.place", { n: place }) };
}

function outcomeOfTeam(result, name) {
  const { place, team } = result.find((entry) => entry.name === name);
  const winners = teamsOf(result.filter((entry) => entry.place === 1 && !entry.left)).map(teamName);
  const won = winners.length > 1 ? t("result.team_draw", { names: list(winners) }) : t("feed.team_win", { team: winners[0] });
  const outcome = place > 1 ? "lose" : winners.length > 1 ? "draw" : "win";
  const text = outcome === "lose" ? `${won} ${t("result.team_place", { team: teamName(team), n: place })}` : won;
  return { outcome, title: t(`result.${outcome}`), text };
}

/**
 * What a player did in a battle, in words, as the referee has counted it.
 * @param {import("../battle/messages.js").Player} own the player's entry in the result
 * @param {boolean} coded whether the light has told who has shot
 */
export function statsTexts(own, coded) {
  const given = coded ? givenTexts(own) : [];
  return [t("result.hits", { n: own.taken }), ...given, t("result.survived", { time: clockText(own.seconds) })];
}

function givenTexts({ shots, hits, kills }) {
  const fired = t("result.shots", { n: shots });
  if (shots === 0) return [fired];
  const accuracy = t("result.accuracy", { accuracy: percent((100 * hits) / shots) });
  return [fired, t("result.given", { n: hits }), accuracy, t("result.kills", { n: kills })];
}

/**
 * Show it, as the state at the battle's end tells it. The focus stays off the buttons: the player may still be hammering the keys.
 * @returns {Promise<""|"ok"|"give">} "ok": a rematch; "give": somebody else may have the seat
 */
export function showResult({ result, coded, battle }, name) {
  const own = result.find((entry) => entry.name === name);
  const { outcome, title, text } = outcomeOf(result, name);
  const stats = statsTexts(own, coded);
  return dialogs.show({
    kind: null,
    look: `result ${outcome}`,
    title,
    text,
    body: [
      podiumView(result, name, coded),
      element("ul", { className: "own-stats" }, ...stats.map((line) => element("li", {}, line))),
      pictureButtons({ title, text, stats, own, result, battle }),
    ],
    ok: t("result.rematch"),
    cancel: t("result.stay"),
    others: [{ value: "give", text: t("result.give_away") }],
    calm: true,
  });
}
