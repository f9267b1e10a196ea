// A worker, which has a thread of its own: it says that the player is still there while the page is too busy to say so.

const PERIOD = 2000; // ms between two looks
const SILENCE = 4000; // ms since the page's own last sign of life

let heard = performance.now();
addEventListener("message", () => (heard = performance.now()));
setInterval(() => {
  if (performance.now() - heard < SILENCE) return;
  fetch("/session", { cache: "no-store" }).catch(() => {}); // any request with the cookie counts
}, PERIOD);
