// The tournament on the desk: open one, call its matches, say who has won where no battle does.

import { championText, sourceText, whenText } from "../battle/tournament.js";
import * as dialogs from "../common/dialogs.js";
import { element, setText } from "../common/dom.js";
import { rowButton, setCell, showRows, tableRow } from "./rows.js";
import { t } from "../common/words.js";

const byId = (id) => document.getElementById(id);

const MATCH = [
  ["match", t("tournament.match_column")], ["stage", t("tournament.stage")], ["players", t("tournament.players")],
  ["score", t("tournament.score")], ["when", t("tournament.when")],
];
const NAMED_ROUNDS = new Set([2, 4, 8]);

export class Tournament {
  #order;
  #problem;
  #state = null;

  /**
   * @param {(order: object, then?: () => void) => Promise<void>} order does what the API's route `tournament` is for
   * @param {(text: string) => void} problem shows what is wrong
   */
  constructor(order, problem) {
    this.#order = order;
    this.#problem = problem;
    byId("tournament-call").addEventListener("click", () => this.#callNext());
    byId("tournament-close").addEventListener("click", () => this.#close());
    byId("tournament-take").addEventListener("click", () => this.#takePlayers());
    byId("tournament-form").addEventListener("submit", (event) => {
      event.preventDefault();
      this.#open();
    });
  }

  /** @param {object} state of GET /operator/api/state */
  show(state) {
    this.#state = state;
    const { tournament } = state;
    byId("tournament-open").hidden = Boolean(tournament?.open);
    byId("tournament-now").hidden = !tournament?.open;
    if (tournament?.open) this.#showNow(tournament);
    showRows(byId("tournament-rows"), tournament?.matches ?? [], {
      key: ({ number }) => String(number),
      make: ({ number }) => this.#row(number),
      fill: (row, match) => fillRow(row, match, tournament),
    });
  }

  #showNow({ title, champion, next }) {
    setText(byId("tournament-name"), title);
    setText(byId("tournament-state"), championText({ champion }));
    const button = byId("tournament-call");
    button.setAttribute("aria-disabled", next === null);
    setText(button.firstElementChild, next === null ? t("tournament.call_none") : t("tournament.call_next", { n: String(next) }));
  }

  #row(number) {
    const about = t("tournament.of_match", { n: String(number) });
    const call = rowButton(t("tournament.call"), about, () => this.#order({ action: "call", number }));
    const decide = rowButton(t("tournament.decide"), about, () => this.#decide(number));
    call.dataset.button = "call";
    decide.dataset.button = "decide";
    return tableRow(MATCH, [call, decide]);
  }

  #callNext() {
    const { next } = this.#state.tournament;
    if (next !== null) this.#order({ action: "call", number: next });
  }

  async #close() {
    const content = { title: t("tournament.close_sure"), text: t("tournament.close_text"), ok: t("tournament.close") };
    const answer = await dialogs.show({ kind: "warning", ...content, cancel: t("common.cancel"), calm: true });
    if (answer) await this.#order({ action: "close" });
  }

  async #decide(number) {
    const { players, winner } = this.#state.tournament.matches[number - 1];
    const reason = element("input", { id: "decide-reason", maxLength: 100, autocomplete: "off" });
    const others = players.map((name, side) => ({ value: `wins ${side}`, text: t("tournament.wins", { name }) }));
    const absent = players.map((name, side) => ({ value: `absent ${side}`, text: t("tournament.absent", { name }) }));
    const answer = await dialogs.show({
      kind: null,
      title: t("tournament.decide_title", { n: String(number) }),
      text: t("tournament.decide_text"),
      body: [element("label", { htmlFor: reason.id }, t("tournament.reason")), reason],
      others: winner === null ? [...others, ...absent] : others,
      ok: null,
      cancel: t("common.cancel"),
    });
    if (!answer) return;
    const [what, side] = answer.split(" ");
    const name = players[Number(side)];
    if (what === "absent") await this.#order({ action: "no_show", number, name });
    else if (reason.value.trim()) await this.#order({ action: "correct", number, winner: name, reason: reason.value.trim() });
    else this.#problem(t("tournament.reason_missing"));
  }

  #takePlayers() {
    const { players, queue } = this.#state;
    byId("tournament-names").value = [...players, ...queue].map(({ name }) => name).join("\n");
  }

  #open() {
    const lines = byId("tournament-names").value.split("\n");
    const order = {
      action: "open",
      names: lines.map((line) => line.trim()).filter(Boolean),
      title: byId("tournament-label").value.trim(),
      kind: byId("tournament-kind").value,
      best_of: Number(byId("tournament-best-of").value),
      third: byId("tournament-third").checked,
      patience: byId("tournament-patience").valueAsNumber * 60,
    };
    this.#order(order, () => {
      byId("tournament-form").reset();
      byId("tournament-open").open = false;
    });
  }
}

function fillRow(row, match, { open, next }) {
  const { number, players, wins, winner, how, called, seconds } = match;
  const begun = winner !== null || wins.some((games) => games > 0);
  const score = begun ? wins.join(" : ") : "";
  setCell(row, "match", String(number));
  setCell(row, "stage", stageText(match));
  setCell(row, "players", players.map((name, side) => name ?? sourceText(match.sources[side])).join(" – "));
  setCell(row, "score", how === null || how === "played" ? score : `${score} (${t(`tournament.${how}`)})`);
  setCell(row, "when", whenCell({ winner, called, seconds, robots: match.robots }));
  const isKnown = players.every((name) => name !== null);
  row.querySelector("[data-button=call]").hidden = !open || !isKnown || winner !== null || number === next;
  row.querySelector("[data-button=decide]").hidden = !open || !isKnown;
  row.classList.toggle("is-out", called);
}

function whenCell({ winner, called, seconds, robots }) {
  if (winner !== null) return t("tournament.wins", { name: winner });
  if (called) return `${t("tournament.now")}: ${robots.map((id) => t("desk.robot_id", { id })).join(", ")}`;
  return seconds === null ? "" : whenText(seconds);
}

function stageText({ group, third, round }) {
  if (group !== null) return t("tournament.group", { n: String(group) });
  if (third) return t("tournament.third_place");
  return NAMED_ROUNDS.has(round) ? t(`tournament.round_${round}`) : t("tournament.round", { n: String(round) });
}
