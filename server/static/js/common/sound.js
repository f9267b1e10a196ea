// The sounds of the game as recipes: what is synthesised, when, how high and how loud. Pure: no audio here.

/**
 * @typedef {object} Voice one oscillator, or noise, of a sound
 * @property {"sine"|"triangle"|"square"|"sawtooth"|"noise"} wave
 * @property {number} at s after the sound's beginning
 * @property {number} lasts s
 * @property {number} level 0 to 1 at its loudest
 * @property {[number, number]} [pitch] Hz at its beginning and end; noise has none
 * @property {[number, number]} [below] Hz: only what is below passes, at its beginning and end
 */

const ATTACK = 0.006; // s from silence to the loudest; without it a voice begins with a click
const SILENT = 0.0001; // an exponential never reaches 0

const tone = (wave, at, lasts, level, pitch, below) => ({ wave, at, lasts, level, pitch, below });
const noise = (at, lasts, level, below) => ({ wave: "noise", at, lasts, level, below });
const still = (hertz) => [hertz, hertz];

/** Notes one after the other, each ringing into the next. */
const melody = (wave, notes, step, rings, level) =>
  notes.map((hertz, index) => tone(wave, index * step, index === notes.length - 1 ? rings * 2 : rings, level, still(hertz)));

const THUMP = [130, 55]; // Hz; lower ones are not heard from a phone

/** @type {Record<string, Voice[]>} */
export const SOUNDS = Object.freeze({
  tick: [tone("sine", 0, 0.09, 0.35, still(660))],
  last: [tone("triangle", 0, 0.14, 0.5, still(880))],
  go: [tone("triangle", 0, 0.5, 0.4, still(1319)), tone("triangle", 0, 0.5, 0.3, still(1760)), noise(0, 0.12, 0.1, [6000, 2000])],
  shot: [tone("sawtooth", 0, 0.2, 0.28, [1700, 170], [5000, 700]), noise(0, 0.05, 0.14, [7000, 3000])],
  given: [tone("triangle", 0, 0.12, 0.42, still(1568)), tone("triangle", 0.07, 0.2, 0.42, still(2093)), noise(0, 0.03, 0.2, [8000, 4000])],
  kill: [...melody("square", [784, 1047, 1568], 0.08, 0.16, 0.2), noise(0, 0.35, 0.4, [2600, 300])],
  hit: [noise(0, 0.3, 0.6, [1800, 150]), tone("square", 0, 0.24, 0.24, [190, 55], [1500, 300])],
  out: [tone("sawtooth", 0, 1, 0.34, [420, 45], [2400, 200]), noise(0.05, 0.8, 0.4, [1400, 100])],
  win: melody("triangle", [523, 659, 784, 1047], 0.13, 0.3, 0.36),
  lose: melody("triangle", [392, 330, 262], 0.22, 0.36, 0.34),
  heartbeat: [tone("sine", 0, 0.14, 0.3, THUMP), tone("sine", 0.2, 0.18, 0.2, THUMP)],
  offer: melody("sine", [1319, 1760, 1319, 1760], 0.16, 0.34, 0.36),
});

/** s that a sound lasts. */
export const lengthOf = (name) => Math.max(...SOUNDS[name].map(({ at, lasts }) => at + lasts));

/**
 * A sound that begins at `now`, ready for an audio context: values at moments, in order.
 * @param {string} name
 * @param {number} now s
 * @returns {{wave: string, start: number, stop: number, level: [number, number][], pitch?: [number, number][],
 *   below?: [number, number][]}[]} each [moment, value]
 */
export function schedule(name, now) {
  return SOUNDS[name].map(({ wave, at, lasts, level, pitch, below }) => {
    const start = now + at;
    const stop = start + lasts;
    const course = (ends) => ends && [[start, ends[0]], [stop, ends[1]]];
    const loudness = [[start, SILENT], [start + ATTACK, level], [stop, SILENT]];
    return { wave, start, stop, level: loudness, pitch: course(pitch), below: course(below) };
  });
}

/** White noise: `length` samples from -1 to 1, the same each time. */
export function noiseSamples(length) {
  let state = 1;
  return Float32Array.from({ length }, () => {
    state = (Math.imul(state, 1664525) + 1013904223) >>> 0; // Numerical Recipes' generator
    return state / 2 ** 31 - 1;
  });
}
