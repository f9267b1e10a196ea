// Teams on a page: the mark of a team, which is a shape as well as a colour, and the choice of the own one.

import { element, icon, setText } from "../common/dom.js";
import { teamName } from "./teams.js";
import { t } from "../common/words.js";

/** An empty mark for showMark. */
export const makeMark = () => element("span", { className: "team-mark", hidden: true });

/** Let a mark show a team: 1 to 4; 0 hides it. `isNamed`: the name can be seen, too, not only heard. */
export function showMark(mark, team, isNamed = false) {
  mark.hidden = team === 0;
  if (mark.dataset.team === String(team)) return;
  mark.dataset.team = team;
  if (team === 0) mark.replaceChildren();
  else mark.replaceChildren(icon(`team${team}`), element("span", { className: isNamed ? "team-name" : "visually-hidden" }, teamName(team)));
}

/** The buttons by which a player chooses a team, or leaves that to the referee. */
export class TeamChoice {
  #box;
  #buttons = new Map(); // team, 0 for no matter which -> button
  #onChoose;

  /**
   * @param {HTMLElement} box gets the buttons
   * @param {(team: number) => void} onChoose
   */
  constructor(box, onChoose) {
    this.#box = box;
    this.#onChoose = onChoose;
  }

  /**
   * @param {{teams: number, own: number, users: import("./messages.js").Player[]}|null} choice null: there is none now
   */
  show(choice) {
    if (!choice && this.#box.contains(document.activeElement)) document.activeElement.blur(); // a hidden button would keep the keys
    this.#box.parentElement.hidden = choice === null;
    if (!choice) return;
    if (this.#buttons.size !== choice.teams + 1) this.#make(choice.teams);
    for (const [team, button] of this.#buttons) {
      button.setAttribute("aria-pressed", team === choice.own);
      const count = choice.users.filter((user) => user.team === team).length;
      if (team > 0) setText(button.lastElementChild, t("teams.members", { n: count }));
    }
  }

  #make(teams) {
    const numbers = [...Array(teams).keys()].map((index) => index + 1);
    this.#buttons = new Map([...numbers, 0].map((team) => [team, this.#makeButton(team)]));
    this.#box.replaceChildren(...this.#buttons.values());
  }

  #makeButton(team) {
    const button = element("button", { type: "button", className: "team-button" });
    button.dataset.team = team;
    button.append(...(team === 0 ? [t("teams.any")] : [icon(`team${team}`), element("strong", {}, teamName(team)), element("small")]));
    button.addEventListener("click", () => this.#onChoose(team));
    return button;
  }
}
