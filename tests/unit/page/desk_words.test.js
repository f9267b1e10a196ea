import assert from "node:assert/strict";
import { afterEach, test } from "node:test";
import { speak } from "./samples.js";
import * as words from "../../../server/static/js/desk/words.js";

afterEach(() => speak("en"));

const game = (values) => ({ state: "stopped", paused: false, time_left: 0, battle: 3, notice: "", message: "", why_no_start: "", ...values });

test("the battle is told in words, with its clock while one runs", () => {
  const told = (values) => words.battleText(game(values));
  assert.deepEqual(told({ notice: "Battle over." }), { title: "No battle", clock: "", hint: "Battle over." });
  assert.match(told({ battle: 1 }).hint, /^1 battle has/);
  assert.match(told({ battle: 0 }).hint, /^0 battles have/);
  assert.deepEqual([told({ state: "countdown", time_left: 8.2 }).title, told({ state: "countdown", time_left: 8.2 }).clock], ["Countdown", "0:09"]);
  assert.deepEqual([told({ state: "playing", time_left: 300 }).title, told({ state: "playing", time_left: 300 }).clock], ["Battle", "5:00"]);
  assert.deepEqual([told({ state: "playing", paused: true, time_left: 9 }).title, told({ state: "playing", paused: true, time_left: 9 }).clock], ["Paused", "0:09"]);
});

test("only what makes sense now may be pressed, and the rest says why not", () => {
  const buttons = (values) => Object.values(words.battleButtons(game(values)));
  const enabled = (values) => buttons(values).filter(({ why }) => why === "").map(({ action }) => action);
  assert.deepEqual(enabled({ why_no_start: "too_few" }), []);
  assert.deepEqual(enabled({}), ["start"]);
  const reasons = (values) => buttons(values).map(({ why }) => why);
  assert.deepEqual(reasons({ why_no_start: "too_few" }).slice(0, 2), [
    "Neither a countdown nor a battle is running.", "It takes two players with robots.",
  ]);
  assert.match(reasons({ why_no_start: "match" })[1], /^This match needs both/);
  const playing = { state: "playing", why_no_start: "runs" };
  assert.equal(reasons(playing)[1], "A battle is running already.");
  assert.deepEqual(enabled({ state: "countdown" }), ["pause", "start", "add_time", "abort"]);
  assert.deepEqual(enabled({ state: "countdown", paused: true }), ["resume", "start", "add_time", "abort"]);
  assert.deepEqual(enabled(playing), ["pause", "add_time", "abort"]);
  assert.deepEqual(enabled({ ...playing, paused: true }), ["resume", "add_time", "abort"]);
});

test("a robot that is silent, or without its serial link, stands out", () => {
  const robot = (values) =>
    words.robotText({ name: "virtual3", host: "virtual3", player: null, offered_to: null, in_service: true, ping_age: 0.3, linked: true, ...values });
  assert.deepEqual(robot({}), {
    host: "virtual3", player: "free", ping: { text: "0 s ago", level: "" }, link: { text: "linked", level: "" },
  });
  assert.equal(robot({ host: "virtual3.local" }).host, "virtual3.local");
  assert.equal(robot({ host: "192.168.1.7" }).host, "virtual3 on 192.168.1.7");
  assert.equal(robot({ host: null }).host, "virtual3");
  assert.equal(robot({ name: null, host: null }).host, "unknown");
  assert.equal(robot({ player: "Ann" }).player, "Ann");
  assert.equal(robot({ offered_to: "Bob" }).player, "offered to Bob");
  assert.equal(robot({ in_service: false }).player, "out of service");
  assert.deepEqual(robot({ ping_age: 3.1 }).ping, { text: "3 s ago", level: "bad" });
  assert.deepEqual(robot({ ping_age: null }).ping, { text: "never", level: "bad" });
  assert.deepEqual(robot({ linked: false }).link, { text: "no link", level: "bad" });
});

test("players and those who wait", () => {
  const player = (values) => words.playerText({ life: 70, ready: true, seat_left: 0, page_age: 0.4, ...values });
  assert.deepEqual(player({}), { life: "70%", ready: "ready", seat: "keeps it", page: { text: "0 s ago", level: "" } });
  assert.equal(player({ seat_left: 12.3 }).seat, "13 s");
  assert.equal(player({ page_age: 9 }).page.level, "bad");
  assert.equal(player({ page_age: 300 }).page.text, "5 min ago");
  assert.equal(words.waiterText({ offer: null, seconds: 170 }), "about 3 minutes");
  assert.equal(words.waiterText({ offer: 0, seconds: 17.5 }), "robot 0 is on offer for 18 s more");
});

test("one word on each line, each once, without the spaces around it", () => {
  assert.deepEqual(words.parseWords(" bad\n\nworse one \r\nbad\n"), ["bad", "worse one"]);
  assert.deepEqual(words.parseWords(""), []);
});

test("the desk speaks the page's language, its numbers and clock too", () => {
  speak("de");
  const over = game({ notice: "Battle over: Bob was shot down." });
  assert.equal(words.battleText(over).hint, "Kampf beendet: Bob wurde abgeschossen.");
  assert.equal(words.battleText(game({ battle: 1 })).hint, "Bisher hat 1 Kampf begonnen.");
  assert.equal(words.playerText({ life: 70, ready: true, seat_left: 0, page_age: 0.4 }).life, "70\u00a0%");
  assert.match(words.timeText(Date.UTC(2026, 10, 24, 12) / 1000), /^\d\d:00:00$/);
});

const board = {
  major: 1, minor: 0, hash: 0xab, reset_cause: 9, uptime: 65, supply: 4950, battery: 0, loop_max: 120, round_trip: 9000,
  serial_errors: 1, resyncs: 2, overruns: 0, packets: 7, bad_packets: 3, shots: 9,
};
const health = (values) => ({ age: 0.4, warnings: [], cpu: 0.25, temperature: 48.6, wifi: -55, under_voltage: false, board, ...values });

test("how a robot is, and what needs a hand first", () => {
  assert.deepEqual(words.healthText(health()), { text: "4.95 V, 49 °C, Wi-Fi -55 dBm", level: "" });
  const sick = health({ warnings: ["low_supply", "deaf"], board: { ...board, supply: 4300, battery: 6100 }, wifi: 0 });
  assert.deepEqual(words.healthText(sick), {
    text: "LOW SUPPLY, DEAF: light on its sensor, 4.3 V, battery 6.1 V, 49 °C",
    level: "bad",
  });
  assert.deepEqual(words.healthText(health({ board: null, temperature: 0, wifi: 0 })), { text: "fine", level: "" });
  assert.equal(words.healthText(null), "no report");
});

test("all that a robot says of itself", () => {
  const text = words.healthDetails(health());
  assert.match(text, /firmware 1\.0 \(00ab\)/);
  assert.match(text, /up 1:05, last reset: power on and watchdog/);
  assert.match(text, /light packets 7, broken ones 3, shots 9/);
  assert.match(words.healthDetails(health({ board: null })), /no report of the Arduino/);
  assert.equal(words.healthDetails(null), "");
});

test("a camera that somebody looks through", () => {
  const row = (values) => words.cameraRow({ robot: 3, viewers: 5, rate: 19.9, age: 0.034, kilobytes: 11.2, state: "live", ...values });
  assert.deepEqual(row(), {
    id: "Robot 3", state: { text: "live", level: "" }, viewers: "5", rate: "19.9/s", age: { text: "0.03 s", level: "" }, size: "11.2 kB",
  });
  assert.equal(row({ robot: 255 }).id, "Camera above the floor");
  assert.equal(row({ age: 1.2 }).age.level, "bad");
  const away = row({ state: "waiting", age: null, kilobytes: null });
  assert.deepEqual([away.state, away.age, away.size], [{ text: "no picture", level: "bad" }, "-", "-"]);
});
