// The floor that is being changed at the desk: what becomes of it when a thing is moved, and what it was before. Pure.

/** @typedef {{width: number, height: number, walls: number[][], starts: number[][], zones: object[]}} Plan as in the floor's file: docs/floor.md */
/** @typedef {{list: "walls"|"starts"|"zones", index: number}} Thing */

export const LISTS = ["walls", "starts", "zones"];
export const ROBOT = 0.075; // m, radius
const GRID = 0.01; // m to which what is dragged keeps
const NOSE = 0.16; // m from the middle of a start place to what turns it
const LEAST_RADIUS = 0.05; // m
const TURN = Math.PI / 36; // rad to which it keeps

/** The plan in a floor's file. */
export const readPlan = ({ width, height, walls = [], starts = [], zones = [] }) => ({ width, height, walls, starts, zones });

export const keyOf = ({ list, index }) => `${list}[${index}]`; // as the server calls it, too

export const isSame = (one, other) => one?.list === other?.list && one?.index === other?.index;

/** Everything on the floor. @returns {Thing[]} */
export const thingsOf = (plan) => LISTS.flatMap((list) => plan[list].map((_, index) => ({ list, index })));

/** Whether it is at a place that can be drawn: a field may be empty. */
export function isPlaced(plan, thing) {
  return (thing.list === "zones" ? ({ x, y, radius }) => [x, y, radius] : (each) => each)(at(plan, thing)).every(Number.isFinite);
}

/** Whether it has a size that can be drawn: a field may be empty. */
export const hasSize = ({ width, height }) => [width, height].every((side) => side >= 0.4 && side <= 20);

/** Where a robot looks that starts there: at the middle of the floor, unless the plan says otherwise. */
export const headingOf = ({ width, height }, [x, y, heading]) => heading ?? Math.atan2(height / 2 - y, width / 2 - x);

/** Move a thing, as far as it stays on the floor. */
export function moved(plan, thing, dx, dy) {
  const points = pointsOf(plan, thing);
  const [x, y] = [within(dx, points.map(([x]) => x), plan.width), within(dy, points.map(([, y]) => y), plan.height)];
  const shifted = points.map(([px, py]) => [px + x, py + y]);
  return withPoints(plan, thing, shifted);
}

/** What can be dragged of a thing by itself: the ends of a wall, the rim of a zone, the nose of a robot. */
export function handlesOf(plan, thing) {
  const one = at(plan, thing);
  if (thing.list === "walls") return [{ name: "end1", x: one[0], y: one[1] }, { name: "end2", x: one[2], y: one[3] }];
  if (thing.list === "zones") return [{ name: "rim", x: one.x + one.radius, y: one.y }];
  const heading = headingOf(plan, one);
  return [{ name: "nose", x: one[0] + NOSE * Math.cos(heading), y: one[1] + NOSE * Math.sin(heading) }];
}

/** Drag such a handle to a point. */
export function dragged(plan, thing, handle, { x, y }) {
  const one = at(plan, thing);
  const point = [clamp(x, plan.width), clamp(y, plan.height)];
  if (handle === "end1") return withPoints(plan, thing, [point, one.slice(2)]);
  if (handle === "end2") return withPoints(plan, thing, [one.slice(0, 2), point]);
  if (handle === "rim") return put(plan, thing, { ...one, radius: Math.max(LEAST_RADIUS, rounded(Math.hypot(x - one.x, y - one.y))) });
  const turn = Math.round(Math.atan2(y - one[1], x - one[0]) / TURN) * TURN;
  return put(plan, thing, [one[0], one[1], exact(turn)]);
}

/** Move such a handle by one step of the keyboard. */
export function nudged(plan, thing, handle, dx, dy) {
  const one = at(plan, thing);
  if (handle === "nose") return put(plan, thing, [one[0], one[1], turned(headingOf(plan, one), TURN * Math.sign(dy - dx))]);
  if (handle === "rim") return put(plan, thing, { ...one, radius: Math.max(LEAST_RADIUS, rounded(one.radius + dx + dy)) });
  const from = handlesOf(plan, thing).find(({ name }) => name === handle);
  return dragged(plan, thing, handle, { x: from.x + dx, y: from.y + dy });
}

/**
 * A new thing in the middle of the floor.
 * @param {"wall"|"start"|"hill"|"pick-up"} kind
 * @returns {[Plan, Thing]}
 */
export function added(plan, kind) {
  const [x, y] = [rounded(plan.width / 2), rounded(plan.height / 2)];
  const long = rounded(Math.min(0.3, plan.height / 4));
  const list = { wall: "walls", start: "starts" }[kind] ?? "zones";
  const made = {
    wall: () => [x, rounded(y - long), x, rounded(y + long)],
    start: () => [x, y, 0],
    hill: () => ({ name: freeName(plan, kind), kind, x, y, radius: rounded(Math.min(0.3, plan.height / 6)) }),
    "pick-up": () => ({ name: freeName(plan, kind), kind, x, y, radius: 0.1 }),
  }[kind]();
  return [{ ...plan, [list]: [...plan[list], made] }, { list, index: plan[list].length }];
}

export const removed = (plan, { list, index }) => ({ ...plan, [list]: plan[list].filter((_, n) => n !== index) });

/**
 * The fields of a thing, as people read them: m and degrees. `value` is NaN where there is none.
 * @returns {{name: string, value: number|string, step?: number}[]}
 */
export function fieldsOf(plan, thing) {
  const one = at(plan, thing);
  if (thing.list === "walls") return ["x1", "y1", "x2", "y2"].map((name, n) => ({ name, value: one[n] ?? NaN, step: GRID }));
  if (thing.list === "zones") {
    return [{ name: "name", value: one.name }, ...["x", "y", "radius"].map((name) => ({ name, value: one[name] ?? NaN, step: GRID }))];
  }
  const degrees = one.length > 2 ? Math.round((one[2] * 1800) / Math.PI) / 10 : NaN;
  return [...["x", "y"].map((name, n) => ({ name, value: one[n] ?? NaN, step: GRID })), { name: "heading", value: degrees, step: 5 }];
}

/** Give a field of a thing another value; NaN: it is empty. */
export function withField(plan, thing, name, value) {
  const one = at(plan, thing);
  const told = Number.isNaN(value) ? null : value; // the server says what is wrong with nothing
  if (thing.list === "zones") return put(plan, thing, { ...one, [name]: told });
  if (name === "heading") return put(plan, thing, told === null ? one.slice(0, 2) : [one[0], one[1], exact((told * Math.PI) / 180)]);
  const index = ["x1", "y1", "x2", "y2"].includes(name) ? ["x1", "y1", "x2", "y2"].indexOf(name) : ["x", "y"].indexOf(name);
  return put(plan, thing, one.map((each, n) => (n === index ? told : each)));
}

/** The floor's file, with a line for each of its things. */
export function toFile(plan) {
  const sides = ["width", "height"].map((side) => `  "${side}": ${JSON.stringify(plan[side])}`);
  const lists = LISTS.map((list) => {
    const things = plan[list].map((thing) => `    ${JSON.stringify(thing)}`);
    return `  "${list}": [${things.length ? `\n${things.join(",\n")}\n  ` : ""}]`;
  });
  return `{\n${[...sides, ...lists].join(",\n")}\n}\n`;
}

/** A plan and those before it. Changes under one `key`, such as of one drag, are one step; null: it is one by itself. */
export class History {
  #steps;
  #saved;
  #key = null;

  constructor(plan) {
    this.#steps = [plan];
    this.#saved = plan;
  }

  get plan() {
    return this.#steps.at(-1);
  }

  get canUndo() {
    return this.#steps.length > 1;
  }

  get isChanged() {
    return JSON.stringify(this.plan) !== JSON.stringify(this.#saved);
  }

  change(plan, key) {
    if (key !== null && key === this.#key && this.canUndo) this.#steps.pop();
    this.#steps.push(plan);
    this.#key = key;
  }

  undo() {
    if (this.canUndo) this.#steps.pop();
    this.#key = null;
  }

  /** The server has this plan now. */
  save(plan) {
    this.#saved = plan;
  }
}

const at = (plan, { list, index }) => plan[list][index];
const put = (plan, { list, index }, one) => ({ ...plan, [list]: plan[list].map((each, n) => (n === index ? one : each)) });
const rounded = (metres) => exact(Math.round(metres / GRID) * GRID);
const exact = (number) => Number(number.toFixed(4));
const clamp = (value, most) => Math.min(most, Math.max(0, rounded(value)));
const turned = (heading, by) => exact(Math.atan2(Math.sin(heading + by), Math.cos(heading + by)));

/** As much of a way as keeps all of these on the floor, to the grid. */
function within(way, values, most) {
  return Math.min(most - Math.max(...values), Math.max(-Math.min(...values), rounded(way)));
}

function pointsOf(plan, thing) {
  const one = at(plan, thing);
  if (thing.list === "zones") return [[one.x, one.y]];
  return thing.list === "walls" ? [one.slice(0, 2), one.slice(2)] : [one.slice(0, 2)];
}

function withPoints(plan, thing, points) {
  const one = at(plan, thing);
  const [first, second] = points.map((point) => point.map(exact));
  if (thing.list === "zones") return put(plan, thing, { ...one, x: first[0], y: first[1] });
  return put(plan, thing, thing.list === "walls" ? [...first, ...second] : [...first, ...one.slice(2)]);
}

function freeName({ zones }, kind) {
  const names = new Set(zones.map(({ name }) => name));
  for (let n = 1; ; n++) if (!names.has(`${kind} ${n}`)) return `${kind} ${n}`;
}
