// Why the last countdown or battle ended: the server says it in English, the page in its own language. Pure.

import { t } from "./words.js";

const SENTENCES = [
  [/^Countdown stopped: (.+), fewer than two players are ready\.$/, "notice.stopped"],
  [/^Countdown stopped: (.+)\.$/, "notice.stopped_by_operator"],
  [/^Battle over: (.+)\.$/, "notice.over"],
  [/^The next battle waits: (.+)\.$/, "notice.waits"],
];

const CAUSES = [
  [/^(?<name>.+) was shot down$/, "notice.shot_down"],
  [/^(?<name>.+) is no longer ready$/, "notice.not_ready"],
  [/^(?<name>.+) lost the robot$/, "notice.lost_robot"],
  [/^(?<name>.+) signed out$/, "notice.signed_out"],
  [/^(?<name>.+) left the page$/, "notice.left_page"],
  [/^(?<name>.+) was signed out by the operator$/, "notice.by_operator"],
  [/^(?<name>.+) makes room for a person$/, "notice.made_room"],
  [/^(?<name>.+) makes room for a match of the tournament$/, "notice.made_room_for_match"],
  [/^(?<name>.+) has a robot that is out of service$/, "notice.out_of_service"],
  [/^(?<name>.+?) signed up again as (?<other>.+)$/, "notice.again"],
  [/^(?<name>.+) did not take the robot in time$/, "notice.missed"],
  [/^(?<name>.+) was not ready for (?<n>\S+) s while others waited$/, "notice.idle"],
  [/^(?<name>.+) has played (?<n>\d+) in a row, and others wait$/, "notice.in_a_row"],
  [/^(?<name>.+) has had the robot for (?<n>\S+) min, and others wait$/, "notice.minutes"],
  [/^(?<name>.+) has one of several robots at one address, and others wait$/, "notice.one_address"],
  [/^robot (?<id>\d+) is about to restart$/, "notice.robot_restarts"],
  [/^the server is about to restart$/, "notice.server_restarts"],
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
    if (match) return t(key, withNumber(match.groups ?? {}));
  }
  return cause;
}

/** A number as text would keep English's point. */
const withNumber = ({ n, ...rest }) => (n === undefined ? rest : { ...rest, n: Number(n) });
