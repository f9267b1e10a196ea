// The logs of all hosts on the operator's desk. They are asked for only while somebody has them open.

import * as api from "./api.js";
import { element, setText } from "../common/dom.js";
import { timeText } from "./words.js";
import { t } from "../common/words.js";

const ASK = 3000; // ms between two questions

const byId = (id) => document.getElementById(id);

export class Journal {
  #version = "";

  start() {
    const ask = () => byId("journal-lines").open && !document.hidden && this.#ask();
    byId("journal-lines").addEventListener("toggle", ask);
    byId("journal-lines").addEventListener("change", ask);
    setInterval(ask, ASK);
  }

  /** @param {boolean} exists whether the server has any to show */
  show(exists) {
    byId("journal").hidden = !exists;
  }

  async #ask() {
    const [host, only] = [byId("journal-host").value, byId("journal-only").checked ? "warnings" : ""];
    let told;
    try {
      told = await api.journal(host, only);
    } catch (error) {
      // the desk says so itself when nothing answers
      if (error.status) showEmpty(error.message);
      return;
    }
    if (host !== byId("journal-host").value) return;
    const version = JSON.stringify(told);
    if (this.#version === version) return; // a selection in it stays
    this.#version = version;
    this.#showHosts(told.hosts);
    byId("journal-rows").replaceChildren(...told.lines.map(row));
    showEmpty(told.lines.length ? "" : t("desk.journal_empty"));
  }

  #showHosts(hosts) {
    const [all, ...known] = byId("journal-host").options;
    if (known.map(({ value }) => value).join() === hosts.join()) return;
    const chosen = byId("journal-host").value;
    byId("journal-host").replaceChildren(all, ...hosts.map((name) => element("option", { value: name }, name)));
    byId("journal-host").value = hosts.includes(chosen) ? chosen : "";
  }
}

function showEmpty(text) {
  byId("journal-empty").hidden = !text;
  setText(byId("journal-empty"), text);
}

function row({ at, host, program, level, text }) {
  const time = element("time", { dateTime: new Date(at * 1000).toISOString() }, timeText(at));
  const line = element("li", {}, time, element("span", {}, element("b", {}, `${host} ${program}`), " "));
  line.dataset.level = level;
  line.lastElementChild.append(text);
  return line;
}
