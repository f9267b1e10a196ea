// A picture as the relay sends it, docs/protocol-camera.md. Pure.

const HEADER = 24; // bytes before the JPEG
export const ABOVE = 255; // stands for a robot's ID where the camera above the floor is meant

/**
 * @typedef {object} Picture
 * @property {number} robot ID
 * @property {number} number grows within the relay's connection to the camera
 * @property {number} taken s of the relay's clock
 * @property {number} sent s of the relay's clock
 * @property {Uint8Array} jpeg
 */

/** @param {ArrayBuffer} message @returns {Picture|null} null for what is none */
export function pictureOf(message) {
  if (message.byteLength <= HEADER) return null;
  const header = new DataView(message, 0, HEADER);
  const taken = header.getFloat64(8, true);
  const sent = header.getFloat64(16, true);
  if (!Number.isFinite(taken) || !Number.isFinite(sent)) return null;
  return { robot: header.getUint8(0), number: header.getUint32(4, true), taken, sent, jpeg: new Uint8Array(message, HEADER) };
}
