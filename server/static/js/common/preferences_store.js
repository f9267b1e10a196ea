// How this browser's player likes to play: kept in localStorage or, where that is blocked, until the page is left.

const KEY = "laserbot-controls";

/** Preference -> [its standard, whether a value is one]. */
const KINDS = {
  sound: [true, isBoolean],
  volume: [0.7, (value) => typeof value === "number" && value >= 0 && value <= 1],
  touch: ["pad", (value) => value === "pad" || value === "stick"],
  hints: [true, isBoolean],
  guide: [true, isBoolean],
  view: ["camera", (value) => value === "camera" || value === "arena"],
  realFloor: [false, isBoolean],
};

function isBoolean(value) {
  return typeof value === "boolean";
}

/**
 * `sound` (boolean), `volume` (0 to 1), `touch` ("pad" or "stick"), `hints` (boolean: whether the page tells the keys),
 * `guide` (boolean: whether the first steps are still to be shown), `view` ("camera": the robot's camera, or "arena") and
 * `realFloor` (boolean: whether robots are drawn on the picture of the camera above the floor).
 */
export class Preferences {
  #getStorage;
  #values = Object.fromEntries(Object.entries(KINDS).map(([name, [standard]]) => [name, standard]));
  #listeners = new Set();

  /** @param {() => Storage} [getStorage] throws where storage is blocked */
  constructor(getStorage = () => localStorage) {
    this.#getStorage = getStorage;
    const kept = this.#load();
    for (const [name, [, isValid]] of Object.entries(KINDS)) {
      if (isValid(kept[name])) this.#values[name] = kept[name];
    }
  }

  get(name) {
    return this.#values[name];
  }

  /** Change a preference and keep it. Throws for a value that is none. */
  set(name, value) {
    if (!KINDS[name]?.[1](value)) throw new Error(`${value} is no preference for ${name}`);
    this.#values[name] = value;
    try {
      this.#getStorage().setItem(KEY, JSON.stringify(this.#values));
    } catch {
      // blocked or full: it holds until the page is left
    }
    for (const listener of this.#listeners) listener(name);
  }

  /** Change a preference that is true or false into the other. */
  toggle(name) {
    this.set(name, !this.get(name));
  }

  /** `listener` is called with a preference's name after each change of it. */
  watch(listener) {
    this.#listeners.add(listener);
  }

  #load() {
    try {
      return JSON.parse(this.#getStorage().getItem(KEY)) ?? {};
    } catch {
      return {}; // blocked, or not ours
    }
  }
}
