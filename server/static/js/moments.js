// Moments that the server writes in UTC, shown in the reader's own time zone and language.

import { dateTime } from "./words.js";

const OPTIONS = {
  moment: { dateStyle: "medium", timeStyle: "short" },
  day: { dateStyle: "full" },
  time: { timeStyle: "short" },
};

/** Each <time data-show="moment|day|time"> of the page. */
export function showMoments() {
  for (const node of document.querySelectorAll("time[data-show]")) {
    node.textContent = dateTime(new Date(node.dateTime), OPTIONS[node.dataset.show]);
  }
}
