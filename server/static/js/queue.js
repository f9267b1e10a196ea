// The words for who waits for a robot. Pure.

/** What /session says of somebody who waits.
 * @typedef {{user: string, place: number, offer: number|null, seconds: number}} Waiter */

/** @param {Waiter} waiter @returns {{title: string, text: string}} */
export function queueText({ place, offer, seconds }) {
  if (offer !== null) {
    return { title: `Robot ${offer} is yours!`, text: `Take it within ${seconds} s, or it goes to the next one.` };
  }
  const title = place === 1 ? "You are next." : `You are number ${place} in the queue.`;
  return { title, text: `About ${waitText(seconds)} until there is a robot. Keep this page open.` };
}

/** Seconds as people say them. */
export function waitText(seconds) {
  const minutes = Math.round(seconds / 60);
  if (minutes < 1) return "a minute";
  return minutes === 1 ? "one minute" : `${minutes} minutes`;
}
