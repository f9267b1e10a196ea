// The page for spectators as a stand: its people cheer for a player, and vote when the operator asks them to.

import { askAudience, leading, send } from "../common/audience.js";
import { element, icon, setText } from "../common/dom.js";
import { presetName } from "../common/preset_names.js";
import { number, t } from "../common/words.js";

const POLL = 1500; // ms
const [DONE, OVER, MUCH] = [200, 410, 429]; // HTTP's statuses

const KEY = "laserbot-vote"; // in localStorage: the vote's number and the choice, so that a page opened anew knows it

const byId = (id) => document.getElementById(id);

export class Audience {
  #choice = -1; // of this device in the vote that is shown
  #number = 0; // of that vote
  #busy = false;
  #cheers = {};

  start() {
    byId("players").addEventListener("click", ({ target }) => {
      const button = target.closest(".cheer");
      if (button) this.#cheer(button.dataset.name);
    });
    setInterval(() => this.#ask(), POLL);
    this.#ask();
  }

  /** Whether there is a vote to be seen. */
  get hasVote() {
    return !byId("vote").hidden;
  }

  /** Show who is cheered for, on the rows of players that there are now. */
  show() {
    for (const button of byId("players").querySelectorAll(".cheer")) {
      const cheers = this.#cheers[button.dataset.name] ?? 0;
      button.dataset.cheers = cheers;
      setText(button.querySelector("b"), cheers > 0 ? number(cheers) : "");
    }
  }

  async #ask() {
    if (this.#busy || document.hidden) return;
    this.#busy = true;
    const told = await askAudience().catch(() => null); // what is known stays
    this.#busy = false;
    if (!told) return;
    this.#cheers = told.cheers;
    this.show();
    this.#showVote(told.vote);
  }

  #showVote(vote) {
    const box = byId("vote");
    box.hidden = vote === null;
    if (!vote) return;
    const choices = byId("vote-choices");
    if (vote.number !== this.#number) {
      this.#number = vote.number;
      this.#choice = keptChoice(vote.number);
      setText(byId("vote-note"), "");
      choices.replaceChildren(...vote.choices.map((choice, index) => element("li", {}, this.#button(choice, index))));
    }
    const isOpen = vote.seconds_left > 0;
    setText(byId("vote-title").firstElementChild, t(isOpen ? "audience.vote" : "audience.vote_over"));
    setText(byId("vote-text"), isOpen ? t("audience.vote_text", { n: Math.ceil(vote.seconds_left) }) : "");
    const all = vote.choices.reduce((sum, { votes }) => sum + votes, 0);
    const ahead = isOpen ? [] : leading(vote);
    [...choices.children].forEach(({ firstElementChild: button }, index) => {
      const { votes } = vote.choices[index];
      button.setAttribute("aria-disabled", !isOpen); // and not `disabled`: that would take the focus away
      button.setAttribute("aria-pressed", index === this.#choice);
      button.classList.toggle("is-ahead", ahead.includes(vote.choices[index]));
      button.style.setProperty("--share", all > 0 ? votes / all : 0);
      setText(button.lastElementChild, t("audience.votes", { n: votes }));
    });
  }

  #button(choice, index) {
    const button = element("button", { type: "button", className: "vote-choice" }, element("strong", {}, presetName(choice)), element("span"));
    button.addEventListener("click", () => this.#vote(index));
    return button;
  }

  async #vote(choice) {
    const status = await send("vote", { number: this.#number, choice }).catch(() => 0);
    if (status === DONE) {
      this.#choice = choice;
      keepChoice(this.#number, choice);
    }
    setText(byId("vote-note"), status === OVER ? t("audience.late") : status === MUCH ? t("audience.full") : "");
    await this.#ask();
  }

  async #cheer(name) {
    if ((await send("cheer", { name }).catch(() => 0)) === DONE) {
      this.#cheers[name] = (this.#cheers[name] ?? 0) + 1; // seen at once
      this.show();
    }
  }
}

function keptChoice(number) {
  try {
    const kept = JSON.parse(localStorage.getItem(KEY));
    return kept?.number === number ? kept.choice : -1;
  } catch {
    return -1;
  }
}

function keepChoice(number, choice) {
  try {
    localStorage.setItem(KEY, JSON.stringify({ number, choice }));
  } catch {
    // blocked or full: it is known until the page is left
  }
}

/** A button to cheer for this player; it also tells how many do. */
export function cheerButton(name) {
  const button = element("button", { type: "button", className: "cheer", title: t("audience.cheer", { name }) }, icon("heart"), element("b"));
  button.dataset.name = name;
  button.append(element("span", { className: "visually-hidden" }, t("audience.cheer", { name })));
  return button;
}
