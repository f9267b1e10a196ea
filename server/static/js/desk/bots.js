// Which robots are for bots, and how good these are.

import { element, setText } from "../common/dom.js";
import { setCell, showRows, tableRow } from "./rows.js";
import { t } from "../common/words.js";

const COLUMNS = [["id", t("desk.robot")], ["player", t("desk.player")], ["bot", t("desk.bot")]];

/**
 * What keeps bots from playing, if robots are for bots at all; empty: nothing does.
 * @param {{bot: string|null}[]} robots
 * @param {"absent"|"blind"|"ready"} program
 */
export function trouble(robots, program) {
  return program !== "ready" && robots.some(({ bot }) => bot !== null) ? t(`desk.bots_${program}`) : "";
}

/** The levels to choose from: none, and those that the server knows. */
const choices = (levels) => [["", t("desk.bot_none")], ...levels.map((level) => [level, t(`desk.bot_${level}`)])];

/**
 * @param {object} state of GET /operator/api/state
 * @param {(id: number, level: string|null) => void} give
 */
export function showBots({ robots, bots }, give) {
  const why = trouble(robots, bots.program);
  const line = document.getElementById("bots-trouble");
  line.hidden = why === "";
  setText(line, why);
  showRows(document.getElementById("bots-rows"), robots, {
    key: ({ id }) => String(id),
    make: ({ id }) => {
      const row = tableRow(COLUMNS, []);
      const select = element("select", { onchange: () => give(id, select.value || null) });
      select.setAttribute("aria-label", t("desk.bot_for", { id }));
      select.append(...choices(bots.levels).map(([value, text]) => element("option", { value }, text)));
      row.querySelector("[data-field=bot]").append(select);
      row.lastElementChild.remove(); // it has no buttons
      return row;
    },
    fill: (row, { id, player, bot }) => {
      setCell(row, "id", t("desk.robot_id", { id }));
      setCell(row, "player", player ?? t("desk.free"));
      const select = row.querySelector("select");
      if (select !== document.activeElement) select.value = bot ?? ""; // nobody chooses just now
    },
  });
}
