// Which keys and thumb positions make which command. Pure: no page, no clock.

/** A laser_bot_battle/Robot_msg that stops the robot. */
export const NEUTRAL = Object.freeze({ linear_x: 0, angular_z: 0, shoot: false });

/** KeyboardEvent.code -> action: the place of the key, whatever the layout. */
const BY_CODE = new Map(
  Object.entries({
    ArrowLeft: "left", KeyA: "left",
    ArrowUp: "up", KeyW: "up",
    ArrowRight: "right", KeyD: "right",
    ArrowDown: "down", KeyS: "down",
    Enter: "shoot", NumpadEnter: "shoot", Space: "shoot",
  }),
);

/** KeyboardEvent.key -> action: for other layouts and for on-screen keyboards, which leave `code` empty. */
const BY_KEY = new Map(
  Object.entries({
    arrowleft: "left", a: "left",
    arrowup: "up", w: "up",
    arrowright: "right", d: "right",
    arrowdown: "down", s: "down",
    enter: "shoot", " ": "shoot",
  }),
);

/**
 * The action of a key: "left", "up", "right", "down", "shoot", or null for a key that is no game key.
 * @param {{code?: string, key?: string}} key a KeyboardEvent, or its two fields
 */
export function actionOf({ code = "", key = "" }) {
  return BY_CODE.get(code) ?? BY_KEY.get(key.toLowerCase()) ?? null;
}

/** Whether a key is the one that shows the camera or the arena, V. @param {{code?: string, key?: string}} key a KeyboardEvent, or its two fields */
export const isViewKey = ({ code = "", key = "" }) => code === "KeyV" || key.toLowerCase() === "v";

/**
 * The Robot_msg for a set of actions; opposite ones cancel.
 * @param {Iterable<string>} actions
 */
export function commandOf(actions) {
  const held = new Set(actions);
  return {
    linear_x: Number(held.has("up")) - Number(held.has("down")),
    angular_z: Number(held.has("right")) - Number(held.has("left")),
    shoot: held.has("shoot"),
  };
}

export function isSameCommand(one, other) {
  return one.linear_x === other.linear_x && one.angular_z === other.angular_z && one.shoot === other.shoot;
}

export function isNeutral(command) {
  return isSameCommand(command, NEUTRAL);
}

const DEAD_ZONE = 0.25; // of the pad's radius: a resting thumb does not drive
const SECTORS = [["right"], ["right", "down"], ["down"], ["down", "left"], ["left"], ["left", "up"], ["up"], ["up", "right"]];

/**
 * The actions of a thumb on the direction pad, in eight equal sectors.
 * @param {number} x right of the pad's centre, 1 = its edge
 * @param {number} y below the pad's centre, 1 = its edge
 */
export function padActions(x, y) {
  if (Math.hypot(x, y) < DEAD_ZONE) return [];
  const eighth = Math.round(Math.atan2(y, x) / (Math.PI / 4));
  return SECTORS[(eighth + 8) % 8];
}
