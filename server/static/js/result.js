// The end of a battle for one who has fought in it: the podium, what this player did, and what comes next.

import * as dialogs from "./dialogs.js";
import { element } from "./dom.js";
import { podiumView } from "./podium.js";
import { clockText } from "./state.js";
import { t } from "./words.js";

/**
 * How it went for `name`. Pure.
 * @param {import("./messages.js").Player[]} result
 * @returns {{outcome: "win"|"draw"|"lose", title: string, text: string}}
 */
export function outcomeOf(result, name) {
  const { place } = result.find((entry) => entry.name === name);
  const tied = result.some((entry) => entry.name !== name && entry.place === place);
  const outcome = place > 1 ? "lose" : tied ? "draw" : "win";
  return { outcome, title: t(`result.${outcome}`), text: t(tied ? "result.shared" : "result.place", { n: place }) };
}

/** What a player did in a battle, in words: see tally.js. */
export function tallyTexts({ hits, shots, seconds }) {
  return [
    t("result.hits", { n: hits }),
    t("result.shots", { n: shots }),
    t("result.survived", { time: clockText(seconds) }),
  ];
}

/**
 * Show it. The focus stays off the buttons: the player may still be hammering the keys.
 * @returns {Promise<""|"ok"|"give">} "ok": a rematch; "give": somebody else may have the seat
 */
export function showResult(result, name, tally) {
  const { outcome, title, text } = outcomeOf(result, name);
  return dialogs.show({
    kind: null,
    look: `result ${outcome}`,
    title,
    text,
    body: [
      podiumView(result, name),
      element("ul", { className: "tally" }, ...tallyTexts(tally).map((line) => element("li", {}, line))),
    ],
    ok: t("result.rematch"),
    cancel: t("result.stay"),
    others: [{ value: "give", text: t("result.give_away") }],
    calm: true,
  });
}
