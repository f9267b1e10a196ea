import assert from "node:assert/strict";
import { once } from "node:events";
import { afterEach, beforeEach, test } from "node:test";
import { WebSocketServer } from "ws";
import { NEUTRAL } from "../../../server/static/js/drive/keys.js";
import { Connection } from "../../../server/static/js/drive/connection.js";
import { message } from "./samples.js";

const FORWARD = { linear_x: 1, angular_z: 0, shoot: false };

const TICKET = { user: "al", ticket: "12.ab" };

let answers = true; // whether that rosbridge answers calls
let server, port, heard, positions, statuses, changes, refusals, roundTrips, calls, connection;

/** A rosbridge that keeps what it hears and answers a subscription with one state. */
async function listen() {
  server = new WebSocketServer({ host: "127.0.0.1", port: port ?? 0 });
  server.on("connection", (socket) =>
    socket.on("message", (data) => {
      const operation = JSON.parse(data);
      if (operation.op === "call_service") {
        calls.push(operation.service);
        const { id, service } = operation;
        if (answers) socket.send(JSON.stringify({ op: "service_response", id, service, values: {}, result: true }));
        return;
      }
      heard.push(operation);
      if (operation.op !== "subscribe") return;
      socket.send(JSON.stringify({ op: "publish", topic: operation.topic, msg: message({ battle: 3 }) }));
    }),
  );
  await once(server, "listening");
  port = server.address().port;
}

async function close() {
  for (const socket of server.clients) socket.terminate();
  await new Promise((resolve) => server.close(resolve));
}

async function until(condition, what) {
  for (const deadline = Date.now() + 10_000; !condition(); ) {
    assert.ok(Date.now() < deadline, `not in time: ${what}`);
    await new Promise((resolve) => setTimeout(resolve, 5));
  }
}

const operations = (op) => heard.filter((operation) => operation.op === op);

/** A started connection whose page gets its tickets from `getTicket`. */
async function connect(getTicket = async () => TICKET) {
  connection?.stop();
  [heard, positions, statuses, changes, refusals, roundTrips, calls] = [[], [], [], [], [], [], []];
  connection = new Connection({
    topics: [{ topic: "/positions", type: "laser_bot_battle/Positions", throttle_rate: 60, take: (message) => positions.push(message) }],
    url: `ws://127.0.0.1:${port}`,
    onStatus: (status) => statuses.push(status),
    onChange: (up) => changes.push(up),
    onRefusal: (reason) => refusals.push(reason),
    onRoundTrip: (ms) => roundTrips.push(ms),
    getTicket,
  });
  connection.start();
  await until(() => statuses.length > 0, "the state");
}

const signedIn = () => until(() => operations("auth").length > 0, "the ticket");

beforeEach(async () => {
  port = undefined;
  await listen();
  await connect();
  await signedIn();
});

afterEach(async () => {
  connection.stop();
  await close();
});

test("the state of the battle and what else is wanted arrive by subscription", async () => {
  assert.deepEqual(operations("subscribe").map(({ topic, type, throttle_rate }) => [topic, type, throttle_rate]), [
    ["/game_status", "laser_bot_battle/GameStatus", undefined],
    ["/positions", "laser_bot_battle/Positions", 60],
  ]);
  await until(() => positions.length === 1, "the positions");
  assert.deepEqual(statuses.map(({ battle }) => battle), [3]);
  assert.deepEqual(changes, [true]);
});

test("commands go to the robot's topic, advertised once before", async () => {
  assert.ok(connection.publish(3, FORWARD));
  assert.ok(connection.publish(3, NEUTRAL));
  await until(() => operations("publish").length === 2, "two commands");
  assert.deepEqual(operations("advertise").map(({ topic, type }) => [topic, type]), [
    ["/Robot3/command", "laser_bot_battle/Robot_msg"],
  ]);
  assert.deepEqual(operations("publish").map(({ topic, msg }) => [topic, msg]), [
    ["/Robot3/command", FORWARD],
    ["/Robot3/command", NEUTRAL],
  ]);
});

test("the next battle advertises anew", async () => {
  connection.publish(3, FORWARD);
  connection.unadvertise();
  connection.publish(3, FORWARD);
  await until(() => operations("publish").length === 2, "two commands");
  assert.deepEqual(heard.map(({ op }) => op).slice(3), ["advertise", "publish", "unadvertise", "advertise", "publish"]);
});

test("a lost connection comes back by itself, and what was commanded meanwhile is never played", async () => {
  connection.publish(3, FORWARD);
  await until(() => operations("publish").length === 1, "the first command");
  await close();
  await until(() => changes.length === 2, "the loss");
  assert.deepEqual(changes, [true, false]);
  assert.equal(connection.publish(3, FORWARD), false);
  heard.length = 0;
  await listen();
  await until(() => connection.up, "the return");
  await signedIn();
  assert.ok(connection.publish(3, NEUTRAL));
  await until(() => operations("publish").length === 1, "a command");
  assert.deepEqual(operations("publish")[0].msg, NEUTRAL);
  assert.deepEqual(operations("advertise").length, 1);
  assert.deepEqual(operations("subscribe").length, 2);
});

test("a connection that has gone silent is replaced", async () => {
  await until(() => operations("subscribe").length === 4, "a new subscription after the silence");
  assert.deepEqual(changes.slice(0, 3), [true, false, true]);
});

test("while commands pile up in front of the network, further ones are dropped and only stops are sent", async () => {
  let sent = 0;
  while (sent < 1000 && connection.publish(3, FORWARD)) sent += 1; // within one turn, so that none can leave
  assert.ok(sent < 10, `${sent} commands were queued`);
  assert.ok(connection.publish(3, NEUTRAL));
  await until(() => operations("publish").length === sent + 1, "what was sent");
  assert.deepEqual(operations("publish").at(-1).msg, NEUTRAL);
});

test("the page says whose it is before the first command", async () => {
  let give;
  await connect(() => new Promise((resolve) => (give = resolve)));
  assert.equal(connection.publish(3, FORWARD), false);
  give(TICKET);
  await until(() => connection.publish(3, FORWARD), "the ticket");
  await until(() => operations("publish").length > 0, "the command");
  assert.deepEqual(heard.map(({ op }) => op).slice(1, 5), ["subscribe", "auth", "advertise", "publish"]);
  assert.deepEqual([operations("auth")[0].client, operations("auth")[0].mac], [TICKET.user, TICKET.ticket]);
});

test("commands do not wait for a web server that is away: the cookie may do", async () => {
  for (const none of [async () => null, () => Promise.reject(new Error("no answer")), () => new Promise(() => {})]) {
    await connect(none);
    await until(() => connection.publish(3, FORWARD), "a command without a ticket");
    await until(() => operations("publish").length > 0, "the command");
    assert.deepEqual(operations("auth"), []);
  }
});

test("a refused command is told, and no other status", async () => {
  const say = (fields) => [...server.clients][0].send(JSON.stringify({ op: "status", level: "error", ...fields }));
  say({ msg: "no player has this name" });
  say({ msg: "only operators may subscribe", id: "subscribe:/x:1" });
  say({ msg: "fine", level: "info", id: "publish:/Robot3/command:7" });
  say({ msg: "not yours", id: "advertise:/Robot3/command:6" });
  say({ msg: "dead", id: "publish:/Robot3/command:7" });
  await until(() => refusals.length > 0 && refusals.at(-1) === "dead", "the refusals");
  assert.deepEqual(refusals, ["not yours", "dead"]);
  await connection.signIn();
  await until(() => operations("auth").length === 2, "another try");
});

test("a stopped connection stays down", async () => {
  connection.stop();
  assert.equal(connection.up, false);
  assert.equal(connection.publish(3, NEUTRAL), false);
  await until(() => server.clients.size === 0, "the socket's end");
});

test("the way to rosbridge and back is measured as soon as the page is signed in", async () => {
  await connect();
  await until(() => roundTrips.length > 0, "a measurement");
  assert.deepEqual(calls, ["/rosapi/get_time"]);
  assert.ok(roundTrips[0] > 0 && roundTrips[0] < 10_000);
});

test("an answer that does not come is told as a way that grows longer", async () => {
  answers = false;
  try {
    await connect();
    await until(() => roundTrips.length > 0, "the second look");
    assert.ok(roundTrips[0] >= 1900);
    assert.equal(calls.length, 1, "it is asked once");
  } finally {
    answers = true;
  }
});
