// What the relay says of a camera, for people in their language. Pure.

import { t } from "../common/words.js";

/** The relay's reasons (server/camera) -> the key of what people read. */
const REASONS = {
  "the camera is looked for": "camera.looking",
  "nothing has been heard from the referee yet": "camera.no_referee",
  "the camera is away": "camera.away",
  "the camera cannot be reached": "camera.unreachable",
  "no picture came for 3 s": "camera.unreachable",
  "the connection to the camera is lost": "camera.unreachable",
  "the camera has ended the stream": "camera.unreachable",
  "in a battle you see through your own robot's camera only": "camera.own_only",
  "the cameras are hidden while a battle runs": "camera.hidden",
};
const BEGINNINGS = new Set(["camera.looking", "camera.no_referee"]);

/** Whether it is not known yet that there is a camera. @param {import("./relay.js").CameraState} state */
export const isUnknown = ({ state, reason }) => state === "waiting" && BEGINNINGS.has(REASONS[reason]);

/** Why there is no picture; empty while there is. @param {import("./relay.js").CameraState} state */
export function cameraText({ state, reason }) {
  if (state === "live") return "";
  if (state === "none") return t("camera.none");
  const key = REASONS[reason];
  return key ? t(key) : t("camera.trouble", { reason });
}
