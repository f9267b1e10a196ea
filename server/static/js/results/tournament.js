// The page of the tournament renews itself when something has changed: nobody touches it in a hall.

import { connectPreferences } from "../common/preferences.js";

const EVERY = 5000; // ms
const TIMEOUT = 4000; // ms

const content = () => document.getElementById("content");

/** The browser asks with the answer's ETag, so the same one costs little. */
async function look() {
  const signal = AbortSignal.timeout(TIMEOUT);
  const response = await fetch(location.pathname, { signal });
  if (!response.ok) return;
  const page = new DOMParser().parseFromString(await response.text(), "text/html");
  const renewed = page.getElementById("content");
  if (renewed.innerHTML !== content().innerHTML) content().replaceChildren(...renewed.childNodes);
}

connectPreferences();
setInterval(() => !document.hidden && look().catch(() => null), EVERY);
