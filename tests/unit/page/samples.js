// States of the battle for the tests.

import { readFileSync } from "node:fs";
import { fromTopic } from "../../../server/static/js/battle/messages.js";
import { setWords } from "../../../server/static/js/common/words.js";

/** Let the page's modules speak a language. */
export function speak(language) {
  const file = new URL(`../../../server/static/words/${language}.json`, import.meta.url);
  setWords(JSON.parse(readFileSync(file, "utf8")), language);
}
speak("en");

export const player = (name, values = {}) => ({
  name, robot: 0, life: 100, ready: false, avatar: 0, place: 0, seat_left: 0, left: false, session: "",
  team: 0, handicap: 0, shots: 0, hits: 0, kills: 0, taken: 0, seconds: 0, wins: 0, weak: false, ...values,
});

/** A laser_bot_battle/GameStatus as rosbridge writes it. */
export const message = (values = {}) => ({
  game: 0, time_left: 0, battle: 0, notice: "", paused: false, message: "", available_robots: 0, practice: false, queue: [],
  users: [], result: [], ...values,
});

/** A laser_bot_battle/GameEvent: `by` has left the one who was hit that `life`. */
export const hit = (number, by, name, life) => ({ number, kind: Number(life === 0), name, by, life });

export const status = (values) => fromTopic(message(values));

/** A picture as the relay sends it. @returns {ArrayBuffer} */
export function picture({ robot = 3, number = 1, taken = 100, sent = 100, jpeg = [1] } = {}) {
  const message = new DataView(new ArrayBuffer(24 + jpeg.length));
  message.setUint8(0, robot);
  message.setUint32(4, number, true);
  message.setFloat64(8, taken, true);
  message.setFloat64(16, sent, true);
  new Uint8Array(message.buffer, 24).set(jpeg);
  return message.buffer;
}
