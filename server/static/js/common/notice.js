// Why the last countdown or battle ended: the server says it in English, the page in its own language. Pure.

import { t } from "./words.js";

const SENTENCES = [
  [/^Countdown stopped: (.+), fewer than two players are ready\.$/, "notice.stopped"],
  [/^Countdown stopped: (.+)\.$/, "notice.stopped_by_operator"],
  [/^Battle over: (.+)\.$/, "notice.over"],
];

const CAUSES = [
  [/^(.+) was shot down$/, "notice.shot_down"],
  [/^(.+) is no longer ready$/, "notice.not_ready"],
  [/^(.+) lost the robot$/, "notice.lost_robot"],
  [/^(.+) signed out$/, "notice.signed_out"],
  [/^(.+) left the page$/, "notice.left_page"],
  [/^(.+) was signed out by the operator$/, "notice.by_operator"],
  [/^(.+) makes room for a person$/, "notice.made_room"],
  [/^the time limit is reached$/, "notice.time"],
  [/^the operator has ended it$/, "notice.operator"],
];

/** The server's notice in the page's language; as it is, if it is a new one. */
export function noticeText(notice) {
  for (const [pattern, key] of SENTENCES) {
    const cause = pattern.exec(notice)?.[1];
    if (cause) return t(key, { cause: causeText(cause) });
  }
  return notice;
}

/** Whether it tells the end of a battle. */
export const saysBattleOver = (notice) => notice.startsWith("Battle over");

function causeText(cause) {
  for (const [pattern, key] of CAUSES) {
    const match = pattern.exec(cause);
    if (match) return t(key, { name: match[1] });
  }
  return cause;
}
