// A battle played again, from its JSON (docs/results.md). Pure: what there was to see at a time in s since it began.

import { arenaColour } from "../battle/teams.js";

const FULL_LIFE = 100;
const NEWS = 4; // s for which what has happened is told
const MOST_NEWS = 3; // at once
const GAP = 5; // s between two sights; in more, nobody knows the way

const turn = (from, to) => ((to - from + 540) % 360) - 180; // the short way, in degrees

/** The place of the newest of the rising `times` that is not after `at`; 0 if all are. */
function newest(times, at) {
  let [low, high] = [0, times.length];
  while (high - low > 1) {
    const middle = (low + high) >> 1;
    if (times[middle] <= at) low = middle;
    else high = middle;
  }
  return low;
}

/** Where the robot was: { x, y, heading, covered } in m and degrees, null if it was not seen; covered: that was predicted. */
export function poseAt(track, robot, at) {
  const { times } = track;
  const seen = track.robots[robot] ?? [];
  const place = newest(times, at);
  const [before, after] = [seen[place], seen[place + 1]];
  if (!before) return null;
  const [x, y, heading, covered = false] = before;
  if (!after || at <= times[place] || times[place + 1] - times[place] > GAP) return { x, y, heading, covered };
  const part = (at - times[place]) / (times[place + 1] - times[place]);
  return { x: x + part * (after[0] - x), y: y + part * (after[1] - y), heading: heading + part * turn(heading, after[2]), covered };
}

/** How the fighter was: { life, hits (taken so far), out (dead, left, or not there yet) }. */
export function fighterAt(timeline, name, at) {
  const own = timeline.filter((moment) => moment.name === name && moment.at <= at);
  const life = own.at(-1)?.life ?? FULL_LIFE;
  const isEarly = timeline.some((moment) => moment.name === name && moment.what === "joined" && moment.at > at);
  return {
    life,
    hits: own.filter((moment) => moment.what === "hit").length,
    out: isEarly || life === 0 || own.some((moment) => moment.what === "left"),
  };
}

/** The robots that were seen, as the picture of the arena draws them. */
export function robotsAt({ fighters, timeline, track }, at) {
  return fighters.flatMap(({ name, robot: id }) => {
    const pose = poseAt(track, id, at);
    if (!pose) return [];
    const { hits } = fighterAt(timeline, name, at);
    return [{ ...pose, id, name, heading: (pose.heading * Math.PI) / 180, beam: false, hits }];
  });
}

/** What was on the floor. @returns {import("../battle/messages.js").Place[]} */
export const placesAt = ({ places }, at) => places.filter(({ since, until }) => since <= at && (until === null || at < until));

/** Whether this effect of a pick-up works for the fighter. */
const hasAt = ({ effects }, fighter, effect, at) =>
  effects.some(({ name, what, since, until }) => name === fighter && what === effect && since <= at && (until === null || at < until));

/** Who played them. @returns {import("../arena/roles.js").Players} */
export function playersAt(battle, at) {
  const { fighters, timeline } = battle;
  const players = fighters.map(({ name, robot, team }) => {
    const { life, out } = fighterAt(timeline, name, at);
    const [shield, doubleDamage] = ["shield", "double damage"].map((effect) => hasAt(battle, name, effect, at));
    return { name, robot, life, out, ready: true, avatar: null, colour: arenaColour(team) ?? null, shield, doubleDamage };
  });
  return { me: null, phase: "", players };
}

/** What has just happened, as its places in the time line, the newest first. */
export const newsAt = ({ timeline }, at) =>
  timeline.flatMap((moment, place) => (moment.at <= at && at < moment.at + NEWS ? [place] : [])).slice(-MOST_NEWS).reverse();

/** How long fighters have held hills so far; who never has is not among them. @returns {Map<string, number>} s by name */
export const pointsAt = ({ points }, at) =>
  new Map(points.filter((point) => point.at <= at).map((point) => [point.name, point.points]));

/** How long there is something to see, with what ends the battle; in whole ms, for a slider keeps no more digits. */
export const lengthOf = ({ seconds, timeline, track }) =>
  Math.ceil(1000 * Math.max(seconds ?? track.times.at(-1), ...timeline.map((moment) => moment.at))) / 1000;

/** Like 4:05. */
export function clock(seconds) {
  const whole = Math.round(seconds);
  return `${Math.floor(whole / 60)}:${String(whole % 60).padStart(2, "0")}`;
}
