import assert from "node:assert/strict";
import { beforeEach, test } from "node:test";
import { StatusFeed } from "../../../server/static/js/battle/status_feed.js";
import { message } from "./samples.js";

let now, timers, sockets, answer, asked, statuses, states, positions;

/** A WebSocket whose other end is the test. */
class Socket {
  sent = [];
  closed = false;

  open() {
    this.onopen();
  }

  say(text) {
    this.onmessage({ data: JSON.stringify(text) });
  }

  tell(values) {
    this.say({ op: "publish", topic: "/game_status", msg: message(values) });
  }

  send(text) {
    this.sent.push(JSON.parse(text));
  }

  close() {
    this.closed = true;
  }
}

const world = {
  open() {
    sockets.push(new Socket());
    return sockets.at(-1);
  },
  ask() {
    asked += 1;
    return answer();
  },
  later(ms, act) {
    const timer = { at: now + ms, act };
    timers.add(timer);
    return () => timers.delete(timer);
  },
  random: () => 0.5,
};

beforeEach(() => {
  [now, timers, sockets, asked, statuses, states, positions] = [0, new Set(), [], 0, [], [], []];
  answer = async () => message({ battle: 7 });
  const topics = [{ topic: "/positions", type: "laser_bot_battle/Positions", take: (message) => positions.push(message) }];
  const wiring = { url: "ws://host:9090", onStatus: (status) => statuses.push(status), onState: (state) => states.push(state) };
  new StatusFeed({ ...wiring, topics }, world).start();
});

/** Time passes; what is due happens, and what was asked is answered. */
async function pass(ms) {
  for (const end = now + ms; now < end; ) {
    now += 100;
    for (const timer of [...timers].filter((one) => one.at <= now)) if (timers.delete(timer)) timer.act();
    await new Promise((resolve) => setImmediate(resolve));
  }
}

const refuse = () => Promise.reject(new Error("no answer"));

test("a guest subscribes once, to the newest state a few times a second", () => {
  sockets[0].open();
  assert.equal(sockets[0].sent.length, 2);
  const { op, topic, type, throttle_rate, queue_length } = sockets[0].sent[0];
  assert.deepEqual([op, topic, type], ["subscribe", "/game_status", "laser_bot_battle/GameStatus"]);
  assert.ok(throttle_rate >= 100, "not as fast as the game changes");
  assert.equal(queue_length, 1, "the newest waits");
});

test("other topics come to who wants them, and are no state of the battle; a refusal of one changes nothing else", () => {
  sockets[0].open();
  assert.deepEqual(sockets[0].sent[1], { op: "subscribe", id: "subscribe:/positions", topic: "/positions", type: "laser_bot_battle/Positions" });
  sockets[0].say({ op: "publish", topic: "/positions", msg: { width: 2 } });
  sockets[0].say({ op: "status", level: "error", id: "subscribe:/positions", msg: "no" });
  assert.deepEqual([positions, statuses, states, sockets[0].closed], [[{ width: 2 }], [], [], false]);
});

test("the state arrives with the names of who waits", async () => {
  sockets[0].open();
  sockets[0].tell({ battle: 3, queue: ["Cy", "Di"], available_robots: 2 });
  assert.deepEqual(states, ["live"]);
  assert.equal(statuses[0].battle, 3);
  assert.deepEqual(statuses[0].waiting, ["Cy", "Di"]);
  assert.equal(statuses[0].free, 2);
  for (let second = 0; second < 20; second += 1) {
    await pass(1000);
    sockets[0].tell({});
  }
  assert.equal(asked, 0, "HTTP is left alone");
  assert.equal(sockets.length, 1);
});

test("where rosbridge has no place, the state comes by HTTP and the socket is tried again, more and more rarely", async () => {
  sockets[0].onclose();
  await pass(60_000);
  assert.equal(statuses.at(-1).battle, 7);
  assert.deepEqual(states, ["live"]);
  assert.ok(asked >= 25 && asked <= 31, `${asked} questions in 60 s`);
  const attempts = sockets.length;
  assert.ok(attempts >= 4 && attempts <= 10, `${attempts} attempts, those without an answer given up`);
});

test("a socket that works ends the questions", async () => {
  sockets[0].onclose();
  await pass(1500);
  sockets[1].open();
  sockets[1].tell({ battle: 8 });
  sockets[1].tell({ battle: 8 });
  const before = asked;
  for (let beat = 0; beat < 20; beat += 1) {
    await pass(500);
    sockets[1].tell({ battle: 8 });
  }
  assert.equal(asked, before);
});

test("a refused subscription counts as no place", async () => {
  sockets[0].open();
  sockets[0].say({ op: "status", level: "error", id: sockets[0].sent[0].id, msg: "no" });
  assert.ok(sockets[0].closed);
  await pass(100);
  assert.equal(statuses[0].battle, 7);
});

test("silence counts as a lost connection", async () => {
  sockets[0].open();
  sockets[0].tell({});
  await pass(3900);
  assert.equal(asked, 0);
  await pass(200);
  assert.equal(asked, 1);
  assert.ok(sockets[0].closed);
});

test("without any answer the server is lost, and found again by either way", async () => {
  answer = refuse;
  sockets[0].onclose();
  await pass(5000);
  assert.deepEqual(states, ["lost"]);
  answer = async () => message({ battle: 9 });
  await pass(4000);
  assert.deepEqual(states, ["lost", "live"]);
  assert.equal(statuses.at(-1).battle, 9);
});

test("the last state of a server that is gone does not make it live", async () => {
  answer = refuse;
  sockets[0].onclose();
  await pass(4000);
  const socket = sockets.at(-1);
  socket.open();
  socket.tell({ battle: 1 });
  assert.deepEqual(states, ["lost"]);
  socket.tell({ battle: 1 });
  assert.deepEqual(states, ["lost", "live"]);
});
