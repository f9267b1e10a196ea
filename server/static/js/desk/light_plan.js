// The light check: each robot flashes in turn, and it is noted who has seen it. Pure; times in ms.

import { list, t } from "../common/words.js";

const FLASH = 1500; // three coded shots
const DARK = 500; // what was seen at the end is on its way; then the next one flashes
const ONE = FLASH + DARK;

/** One light check, begun when it is made. */
export class LightPlan {
  #robots;
  #began;
  #seen = new Map(); // whose light -> who has seen it

  /** @param {number[]} robots IDs @param {number} now */
  constructor(robots, now) {
    this.#robots = robots;
    this.#began = now;
  }

  get robots() {
    return this.#robots;
  }

  /** Whose turn it is, and whether it is to flash; null: all have had theirs. @returns {{robot: number, shoot: boolean}|null} */
  turn(now) {
    const passed = now - this.#began;
    const robot = this.#robots[Math.floor(passed / ONE)];
    return robot === undefined ? null : { robot, shoot: passed % ONE < FLASH };
  }

  /** `by` has seen light; `shooter` says whose, if it is coded. */
  saw(by, shooter, now) {
    const whose = shooter ?? this.turn(now)?.robot;
    if (whose === undefined || whose === by || !this.#robots.includes(whose)) return;
    this.#seen.set(whose, (this.#seen.get(whose) ?? new Set()).add(by));
  }

  /** Who has seen this robot's light. */
  seenBy(robot) {
    return [...(this.#seen.get(robot) ?? [])].sort((one, other) => one - other);
  }

  /** Whose light this robot has seen. */
  sawOf(robot) {
    return this.#robots.filter((other) => this.#seen.get(other)?.has(robot));
  }

  /** Whether this robot has had its turn. */
  isDone(robot, now) {
    return now - this.#began >= ONE * (this.#robots.indexOf(robot) + 1);
  }
}

/** Why no light check can be made now; empty if one can. */
export function whyNoCheck(game, robots, practice) {
  if (game.state !== "stopped") return t("desk.check_battle");
  const linked = robots.filter((robot) => robot.linked).length;
  if (practice && robots.some((robot) => robot.linked && robot.player !== null)) return t("desk.check_practice");
  return linked >= 2 ? "" : t("desk.check_too_few", { n: linked });
}

/** What the table says of a robot. `ended`: the check is over, completed or not. */
export function checkRow(plan, robot, now, ended) {
  const [seen, saw] = [plan.seenBy(robot), plan.sawOf(robot)];
  const flashes = !ended && plan.turn(now)?.robot === robot;
  const waiting = { text: flashes ? t("desk.check_flashes") : "-" };
  const nobody = { text: t("desk.check_nobody"), level: "bad" };
  const names = (ids) => ({ text: list(ids.map(String)) });
  return {
    seen: seen.length ? names(seen) : plan.isDone(robot, now) ? nobody : waiting,
    saw: saw.length ? names(saw) : plan.turn(now) === null ? { text: t("desk.check_none"), level: "bad" } : { text: "-" },
  };
}

/** The result in a sentence; the robots without a tick are those that nobody has seen, or that have seen nobody. */
export function checkResult(plan) {
  const bad = plan.robots.filter((robot) => plan.seenBy(robot).length === 0 || plan.sawOf(robot).length === 0);
  return bad.length ? t("desk.check_bad", { robots: list(bad.map(String)) }) : t("desk.check_good");
}
