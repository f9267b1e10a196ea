// What the stage shows of a hit: to the shooter a cross in its middle, to the victim whose shot it was.

import { avatarUrl } from "../common/assets.js";
import { setPicture, setText } from "../common/dom.js";
import { hitsOf, newHits } from "../battle/hits.js";
import { number, t } from "../common/words.js";

const MARK = { hit: 900, kill: 1600 }; // ms
const NOTE = 2600; // ms

const calm = matchMedia("(prefers-reduced-motion: reduce)");

export class HitMarks {
  #mark;
  #note;
  #timers = new Map(); // by element

  /**
   * @param {HTMLElement} mark with a <strong> and a <span>
   * @param {HTMLElement} note with an <img> and a <span>
   */
  constructor(mark, note) {
    this.#mark = mark;
    this.#note = note;
  }

  /** A new state of the battle has arrived. */
  take(previous, current, name) {
    const { given, taken } = hitsOf(newHits(previous, current), current, name);
    if (given.length > 0) this.#showGiven(given);
    const last = taken.at(-1);
    if (last?.by) this.#showTaken(last, [...current.users, ...current.result].find((user) => user.name === last.by));
  }

  #showGiven(given) {
    const kills = given.filter(({ life }) => life === 0);
    const kind = kills.length > 0 ? "kill" : "hit";
    this.#mark.dataset.kind = kind;
    setText(this.#mark.querySelector("strong"), `+${number(given.length)}`);
    setText(this.#mark.querySelector("span"), kills.length > 0 ? t("game.kill", { name: kills.at(-1).name }) : given.at(-1).name);
    this.#flash(this.#mark, MARK[kind]);
  }

  #showTaken({ by, life }, shooter) {
    const picture = this.#note.querySelector("img");
    picture.hidden = !shooter;
    if (shooter) setPicture(picture, avatarUrl(shooter.avatar));
    setText(this.#note.querySelector("span"), t(life > 0 ? "game.hit_by" : "game.out_by", { name: by }));
    this.#flash(this.#note, NOTE);
  }

  #flash(node, ms) {
    node.hidden = false;
    clearTimeout(this.#timers.get(node));
    this.#timers.set(node, setTimeout(() => (node.hidden = true), ms));
    if (calm.matches) return;
    node.animate([{ transform: "scale(1.7)", opacity: 0 }, { transform: "scale(1)", opacity: 1 }], { duration: 140, easing: "ease-out" });
  }
}
