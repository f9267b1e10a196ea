import assert from "node:assert/strict";
import { beforeEach, test } from "node:test";
import { FloorPicture } from "../../../server/static/js/overhead/floor_picture.js";

const VIEW = {
  width: 40, height: 20, homography: [0.5, 0, -1, 0, -0.5, 0.5, 0, 0, 1], bend: 0, camera: [2, 1, 2], tag_height: 0.1,
};
const FRAME = { left: 0, bottom: 0, right: 4, top: 2 };

let now, tick, camera, shown, states, picture;

/** The relay's end of it. */
class Camera {
  constructor(wiring) {
    Object.assign(this, wiring);
    this.robot = null;
    this.isOn = false;
  }

  watch(robot) {
    this.robot = robot;
  }

  start() {
    this.isOn = true;
  }

  stop() {
    this.isOn = false;
  }
}

/** A canvas of one colour. */
class Canvas {
  constructor(width, height) {
    Object.assign(this, { width, height, colour: 0 });
  }

  getContext() {
    const data = (width, height) => ({ data: { buffer: new Uint32Array(width * height).fill(this.colour).buffer } });
    return {
      drawImage: ({ colour }) => (this.colour = colour),
      getImageData: (_x, _y, width, height) => data(width, height),
      createImageData: data,
      putImageData: ({ data: { buffer } }) => (this.colour = new Uint32Array(buffer)[0]),
    };
  }
}

const world = {
  camera: (wiring) => (camera = new Camera(wiring)),
  canvas: (width, height) => new Canvas(width, height),
  now: () => now,
  every(_, act) {
    tick = act;
    return () => (tick = null);
  },
};

const see = (values = {}) => picture.topics[0].take({ ...VIEW, ...values });
const come = (colour, takenAt = now, size = {}) => camera.onPicture({ width: 40, height: 20, colour, ...size }, takenAt);

/** Time passes, in s. */
function pass(seconds) {
  now += seconds;
  tick?.();
}

beforeEach(() => {
  [now, tick, shown, states] = [100, null, [], []];
  const wiring = {
    url: "ws://host:9091/",
    level: "floor",
    onPicture: (canvas) => shown.push(canvas && canvas.colour),
    onState: (state) => states.push(state),
  };
  picture = new FloorPicture(wiring, world);
  picture.frame = FRAME;
});

/** Somebody looks, and pictures come. */
function look() {
  see();
  picture.look(true);
  camera.onState({ robot: 255, state: "live", reason: "" });
}

test("without a camera above the floor there is none, and with one nothing is fetched until somebody looks", () => {
  assert.deepEqual([picture.state, camera.isOn, tick], ["none", false, null]);
  see();
  assert.deepEqual([picture.state, camera.isOn, tick], ["off", false, null]);
  picture.look(true);
  assert.deepEqual([picture.state, camera.isOn, camera.robot], ["waiting", true, 255]);
  picture.look(false);
  assert.deepEqual([picture.state, camera.isOn, tick], ["off", false, null]);
});

test("pictures are shown as they come, no more than five a second", () => {
  look();
  come(11);
  come(12);
  assert.deepEqual([shown, states, camera.pace], [[11, 12], ["off", "waiting", "live"], 200]);
});

test("whoever does not want to look any more sees nothing, and a picture on its way is not shown", () => {
  look();
  come(11);
  picture.look(false);
  come(12);
  assert.deepEqual([shown, picture.state], [[11, null], "off"]);
});

test("an old picture is never shown, nor does one stay until it is old", () => {
  look();
  come(11, now - 1);
  assert.deepEqual(shown, []);
  come(12, now - 0.5);
  pass(0.4);
  assert.deepEqual(shown, [12]);
  pass(0.2);
  assert.deepEqual([shown, picture.state], [[12, null], "away"]);
  come(13);
  assert.deepEqual([shown, picture.state], [[12, null, 13], "live"]);
});

test("a picture like the one before is newer, and one that nobody has seen is asked for again", () => {
  look();
  assert.equal(camera.onPicture(null, now), false, "the one before came before somebody looked");
  assert.equal(come(11), true);
  pass(0.4);
  assert.equal(camera.onPicture(null, now), true);
  pass(0.4);
  assert.deepEqual([shown, picture.state], [[11], "live"]);
  picture.frame = { ...FRAME, right: 2 };
  assert.equal(camera.onPicture(null, now), false, "it was laid for another frame");
});

test("a camera that is away is told at once, and one of which nothing is heard after 3 s", () => {
  look();
  come(11);
  camera.onState({ robot: 255, state: "waiting", reason: "the camera is away" });
  come(12); // says no more than that
  assert.deepEqual([shown, picture.state], [[11, null], "away"]);
  picture.look(false);
  picture.look(true);
  pass(2.9);
  assert.equal(picture.state, "waiting");
  pass(0.2);
  assert.equal(picture.state, "away");
});

test("while the tracker does not know where the floor is, or the camera's pictures have another size, there is none", () => {
  look();
  come(11);
  see({ width: 0 });
  come(12);
  assert.deepEqual([shown, picture.state], [[11, null], "away"]);
  see();
  come(13, now, { width: 80 });
  come(14);
  assert.deepEqual([shown, picture.state], [[11, null, 14], "live"]);
});

test("by default, what is as high as the tags is at its place", () => {
  const colours = (level) => {
    picture = new FloorPicture({ url: "", level, onPicture: (canvas) => shown.push(canvas.colour) }, world);
    picture.frame = FRAME;
    look();
    come(11);
    return shown.pop();
  };
  assert.deepEqual([colours("floor"), colours("tags"), colours(undefined)], [11, 0, 0]); // of the first pixel
});
