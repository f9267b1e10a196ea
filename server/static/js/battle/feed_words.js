// The feed on a page: what happens, in words, newest first.

import { avatarUrl } from "../common/assets.js";
import { element, setPicture } from "../common/dom.js";
import { changes } from "./feed.js";
import { PlaceNews } from "./feed_places.js";
import { teamName } from "./teams.js";
import { list, percent, t } from "../common/words.js";

const MOST = 6; // entries
const FRESH = 12_000; // ms that an entry stands out

const TONES = {
  countdown: "alert", start: "alert", resumed: "alert", ready: "good", hit: "hit", out: "out", end: "win",
  hill: "good", repair: "good", shield: "good", double_damage: "good",
};

/**
 * A change in words. `mark` is done to each name in them.
 * @param {import("./feed.js").Change} change
 * @returns {{text: string, avatar: number|null, victim: number|null, tone: "alert"|"good"|"hit"|"out"|"win"|"calm"}}
 *   `victim`: the second picture, of the one whom the first has hit
 */
export function feedEntry({ kind, name, avatar, life, by, winners, teams }, mark = (one) => one) {
  const tone = TONES[kind] ?? "calm";
  if (kind === "end") return { text: endText(winners.map(mark), teams), avatar, victim: null, tone };
  const values = { name: mark(name), life: life === null ? "" : percent(life) };
  if (by) return { text: t(`feed.${kindBy(kind, by)}`, { ...values, by: mark(by.name), n: by.streak }), avatar: by.avatar, victim: avatar, tone };
  return { text: t(`feed.${kind}`, values), avatar, victim: null, tone };
}

function kindBy(kind, { streak, revenge }) {
  if (revenge) return "revenge";
  return streak > 1 ? "streak" : `${kind}_by`;
}

function endText(winners, teams) {
  if (teams.length === 1) return t("feed.team_win", { team: teamName(teams[0]) });
  if (teams.length > 1) return t("feed.draw", { names: list(teams.map(teamName)) });
  if (winners.length === 0) return t("feed.over");
  return winners.length === 1 ? t("feed.win", { name: winners[0] }) : t("feed.draw", { names: list(winners) });
}

const [ISOLATE, POP] = ["\u2068", "\u2069"]; // no name has them
const isolated = (name) => `${ISOLATE}${name}${POP}`;

/** A text with isolated names as it stands on a page: a name that has no room is cut, not broken, and is whole in its title. */
function withNames(text) {
  return text.split(new RegExp(`[${ISOLATE}${POP}]`, "u")).map((part, index) => (index % 2 ? element("bdi", { title: part }, part) : part));
}

/** Keeps the newest entries in a list of the page. It is silent: what screen readers say is the page's own choice. */
export class FeedList {
  #list;
  #timers = new Map(); // by node
  #places = new PlaceNews();

  /** @param {HTMLOListElement|HTMLUListElement} node */
  constructor(node) {
    this.#list = node;
    node.setAttribute("aria-live", "off");
  }

  /**
   * Show what has changed between two states of the battle.
   * @returns {import("./feed.js").Change[]} the changes
   */
  take(previous, current) {
    const news = [...this.#places.take(previous, current), ...changes(previous, current)];
    for (const change of news) this.#add(feedEntry(change, isolated));
    return news;
  }

  #add({ text, avatar, victim, tone }) {
    const node = this.#list.children.length < MOST ? makeNode() : this.#list.lastElementChild;
    clearTimeout(this.#timers.get(node));
    this.#timers.set(node, setTimeout(() => node.classList.add("is-old"), FRESH));
    node.classList.remove("is-old");
    node.dataset.tone = tone;
    showPicture(node.firstElementChild, avatar);
    showPicture(node.lastElementChild, victim);
    node.querySelector("span").replaceChildren(...withNames(text));
    this.#list.prepend(node);
  }
}

function makeNode() {
  const picture = () => element("img", { alt: "", width: 40, height: 40 });
  return element("li", { className: "feed-entry" }, picture(), element("span"), picture());
}

function showPicture(picture, avatar) {
  picture.hidden = avatar === null;
  if (avatar !== null) setPicture(picture, avatarUrl(avatar));
}
