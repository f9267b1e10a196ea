import assert from "node:assert/strict";
import { beforeEach, test } from "node:test";
import { Camera } from "../../../server/static/js/camera/relay.js";
import { picture } from "./samples.js";

let now, timers, sockets, hidden, tellHiding, decoding, states, drawn, figures, camera;

/** A WebSocket whose other end is the test. */
class Socket {
  readyState = WebSocket.CONNECTING;
  sent = [];

  open() {
    this.readyState = WebSocket.OPEN;
    this.onopen();
  }

  say(text) {
    this.onmessage({ data: JSON.stringify(text) });
  }

  tell(state, robot = 3, reason = "") {
    this.say({ op: "camera", robot, state, reason });
  }

  show(values) {
    this.onmessage({ data: picture(values) });
  }

  send(text) {
    this.sent.push(JSON.parse(text));
  }

  close() {
    this.readyState = WebSocket.CLOSED;
  }
}

const world = {
  open() {
    sockets.push(new Socket());
    return sockets.at(-1);
  },
  decode: ([first]) =>
    new Promise((resolve, reject) => decoding.push({ first, done: () => resolve({ first, close() {} }), fail: reject })),
  now: () => now,
  later(ms, act) {
    const timer = { at: now + ms / 1000, act };
    timers.add(timer);
    return () => timers.delete(timer);
  },
  random: () => 0.5,
  isHidden: () => hidden,
  onHiding: (act) => (tellHiding = act),
};

const settle = () => new Promise(setImmediate);
const ops = (socket, op) => socket.sent.filter((message) => message.op === op);
const watched = (socket) => ops(socket, "watch").map(({ robot }) => robot);

/** Time passes, in s; what is due happens. */
function pass(seconds) {
  now += seconds;
  for (const timer of [...timers].filter(({ at }) => at <= now)) {
    timers.delete(timer);
    timer.act();
  }
}

async function finish(place = 0) {
  decoding.splice(place, 1)[0].done();
  await settle();
}

function make(options = {}) {
  camera = new Camera(
    {
      url: "ws://host:9091/",
      onState: (state) => states.push(state),
      onPicture: (bitmap, takenAt) => drawn.push([bitmap?.first, takenAt]),
      onFigures: (told) => figures.push(told),
      ...options,
    },
    world,
  );
  camera.watch(3);
  camera.start();
  sockets.at(-1).open();
}

beforeEach(() => {
  [now, timers, sockets, hidden, decoding, states, drawn, figures] = [0, new Set(), [], false, [], [], [], []];
  make();
});

test("it says which camera it wishes for and hears what became of that", () => {
  assert.deepEqual(watched(sockets[0]), [3]);
  sockets[0].tell("waiting", 3, "the camera is away");
  sockets[0].tell("live");
  sockets[0].tell("live", 9); // of an older wish
  assert.deepEqual(states, [
    { robot: 3, state: "waiting", reason: "the camera is away" },
    { robot: 3, state: "live", reason: "" },
  ]);
});

test("a picture is drawn with the moment when it was taken by the page's clock, and then it is seen", async () => {
  sockets[0].tell("live");
  now = 50;
  sockets[0].show({ taken: 999.9, sent: 1000, jpeg: [1] });
  assert.equal(ops(sockets[0], "seen").length, 0);
  await finish();
  assert.equal(drawn[0][0], 1);
  assert.ok(Math.abs(drawn[0][1] - 49.9) < 1e-6);
  assert.equal(ops(sockets[0], "seen").length, 1);
});

test("a picture of the same bytes is not decoded again, but it is newer", async () => {
  sockets[0].tell("live");
  sockets[0].show({ taken: 1, sent: 1, jpeg: [1, 2] });
  await finish();
  now = 1;
  sockets[0].show({ taken: 2, sent: 2, jpeg: [1, 2] });
  await settle();
  assert.equal(decoding.length, 0);
  assert.deepEqual(drawn.map(([first]) => first), [1, undefined]);
  assert.equal(drawn[1][1] - drawn[0][1], 1);
  assert.equal(ops(sockets[0], "seen").length, 2);
});

test("the first picture of another wish is decoded whatever the one before looked like", async () => {
  sockets[0].tell("live");
  sockets[0].show({ jpeg: [1, 2] });
  await finish();
  camera.watch(4);
  sockets[0].tell("live", 4);
  sockets[0].show({ robot: 4, jpeg: [1, 2] });
  assert.equal(decoding.length, 1);
});

test("one picture is decoded at a time, and of those that wait only the newest is drawn; all are seen", async () => {
  sockets[0].tell("live");
  for (const first of [1, 2, 3]) sockets[0].show({ jpeg: [first] });
  assert.deepEqual(decoding.map(({ first }) => first), [1]);
  await finish();
  assert.deepEqual(decoding.map(({ first }) => first), [3]);
  await finish();
  assert.deepEqual(drawn.map(([first]) => first), [1, 3]);
  assert.equal(ops(sockets[0], "seen").length, 3);
});

test("a page that wants fewer pictures asks for them more slowly, and gets the newest", async () => {
  make({ pace: 200 });
  sockets[1].tell("live");
  const show = async (first) => {
    sockets[1].show({ jpeg: [first] });
    await finish();
  };
  const seen = () => ops(sockets[1], "seen").length;
  await show(1);
  assert.equal(seen(), 1);
  now += 0.05;
  await show(2); // of two that may be on their way
  await show(3);
  assert.equal(seen(), 1);
  pass(0.16);
  assert.equal(seen(), 2);
  pass(0.2);
  assert.equal(seen(), 3);
  await show(4);
  pass(0.1);
  assert.equal(seen(), 3);
  camera.stop();
  pass(0.2);
  assert.equal(seen(), 3);
  assert.deepEqual(drawn.map(([first]) => first), [1, 2, 3, 4]);
});

test("a broken picture is skipped, and the next one is drawn", async () => {
  sockets[0].tell("live");
  sockets[0].show({ jpeg: [1] });
  decoding.pop().fail(new Error("no JPEG"));
  await settle();
  sockets[0].show({ jpeg: [2] });
  await finish();
  assert.deepEqual(drawn.map(([first]) => first), [2]);
});

test("a picture of the camera before is not drawn", async () => {
  sockets[0].tell("live");
  sockets[0].show({ robot: 3 });
  camera.watch(4);
  await finish();
  assert.deepEqual(drawn, []);
  assert.deepEqual(watched(sockets[0]), [3, 4]);
});

test("a picture that is refused while it is decoded is not drawn", async () => {
  sockets[0].tell("live");
  sockets[0].show();
  sockets[0].tell("refused", 3, "the cameras are hidden while a battle runs");
  await finish();
  assert.deepEqual(drawn, []);
  assert.equal(ops(sockets[0], "seen").length, 1);
});

test("a camera that is away may send a picture that says so", async () => {
  sockets[0].tell("waiting", 3, "the camera is away");
  sockets[0].show();
  await finish();
  assert.equal(drawn.length, 1);
});

test("while the page is hidden it looks through no camera", () => {
  hidden = true;
  tellHiding();
  hidden = false;
  tellHiding();
  assert.deepEqual(watched(sockets[0]), [3, null, 3]);
});

test("it comes back by itself, later and later, with its wish", () => {
  for (const wait of [0.5, 1, 2, 4, 8, 8]) {
    sockets.at(-1).onclose();
    const count = sockets.length;
    pass(wait - 0.01);
    assert.equal(sockets.length, count, `before ${wait} s`);
    pass(0.02);
    assert.equal(sockets.length, count + 1, `after ${wait} s`);
  }
  sockets.at(-1).open();
  assert.deepEqual(watched(sockets.at(-1)), [3]);
  sockets.at(-1).tell("live");
  sockets.at(-1).onclose();
  pass(0.51);
  assert.equal(sockets.length, 8); // it had answered: soon again
});

test("a connection on which pictures should come, and none do, is given up", () => {
  sockets[0].tell("live");
  pass(4);
  sockets[0].show();
  pass(4);
  assert.equal(sockets[0].readyState, WebSocket.OPEN);
  pass(1.1);
  assert.equal(sockets[0].readyState, WebSocket.CLOSED);
});

test("a camera that is away may be silent for long", () => {
  sockets[0].tell("none");
  pass(600);
  assert.equal(sockets[0].readyState, WebSocket.OPEN);
});

test("a network that does not even refuse is tried again", () => {
  sockets[0].onclose();
  pass(1);
  pass(4.1);
  pass(2);
  assert.equal(sockets.length, 3);
});

test("it says whose page it is, and an operator's has no name", async () => {
  make({ getTicket: async () => ({ user: "al", ticket: "12.ab" }) });
  await settle();
  assert.deepEqual(ops(sockets[1], "auth"), [{ op: "auth", mac: "12.ab", client: "al" }]);
  make({ getTicket: async () => ({ ticket: "13.cd" }) });
  await settle();
  assert.deepEqual(ops(sockets[2], "auth"), [{ op: "auth", mac: "13.cd" }]);
});

test("without a ticket it looks all the same", async () => {
  make({ getTicket: () => Promise.reject(new Error("no answer")) });
  await settle();
  assert.deepEqual(sockets[1].sent, [{ op: "watch", robot: 3 }]);
});

test("operators get the figures that they ask for", () => {
  camera.askFigures();
  assert.equal(ops(sockets[0], "figures").length, 1);
  sockets[0].say({ op: "figures", viewers: 12 });
  assert.deepEqual(figures, [{ op: "figures", viewers: 12 }]);
});

test("what has been stopped stays so", () => {
  sockets[0].onclose();
  camera.stop();
  pass(60);
  assert.equal(sockets.length, 1);
});
