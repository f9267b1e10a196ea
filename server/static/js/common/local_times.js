// Moments and days as the server writes them, shown in the reader's own time zone and language.

import { dateTime } from "./words.js";

const OPTIONS = {
  moment: { dateStyle: "full", timeStyle: "short" },
  day: { dateStyle: "full", timeZone: "UTC" }, // a day of the calendar, which is the same in each time zone
  time: { timeStyle: "short" },
};

/** Each <time data-show="moment|day|time"> of the page. */
export function showMoments() {
  for (const node of document.querySelectorAll("time[data-show]")) {
    node.textContent = dateTime(new Date(node.dateTime), OPTIONS[node.dataset.show]);
  }
}
