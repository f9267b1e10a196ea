// What people who watch do together: cheer, and vote (docs/protocol-browser.md, "Spectators"). The HTTP rim.

const TIMEOUT = 4000; // ms

/**
 * @typedef {{name: string, own: boolean, votes: number}} Choice a preset
 * @typedef {{number: number, choices: Choice[], seconds_left: number}} Vote
 */

/** @returns {Promise<{vote: Vote|null, cheers: Record<string, number>}>} */
export async function askAudience() {
  const response = await fetch("/audience", { cache: "no-store", signal: AbortSignal.timeout(TIMEOUT) });
  if (!response.ok) throw new Error(`/audience: ${response.status}`);
  return response.json();
}

/** @returns {Promise<number>} HTTP's status */
export async function send(what, values) {
  const response = await fetch(`/audience/${what}?${new URLSearchParams(values)}`, { method: "POST", signal: AbortSignal.timeout(TIMEOUT) });
  return response.status;
}

/** The choices with the most votes; none without any vote. @param {Vote} vote */
export function leading({ choices }) {
  const most = Math.max(...choices.map(({ votes }) => votes));
  return most === 0 ? [] : choices.filter(({ votes }) => votes === most);
}
