// Tyre tracks that fade.

import { TRACK_SECONDS } from "./memory.js";

const SHADES = 5;

/** Draw one robot's track; the context is in metres, y up. */
export function drawTrack(context, track, colour, now) {
  context.strokeStyle = colour;
  context.lineWidth = 0.012;
  context.lineJoin = context.lineCap = "round";
  for (let shade = 0; shade < SHADES; shade++) {
    const isOfShade = ({ time }) => Math.min(SHADES - 1, Math.floor((SHADES * (now - time)) / TRACK_SECONDS)) === shade;
    const first = track.findIndex((point, n) => n > 0 && isOfShade(point));
    if (first < 0) continue;
    context.globalAlpha = 0.28 * (1 - (shade + 0.5) / SHADES);
    context.beginPath();
    context.moveTo(track[first - 1].x, track[first - 1].y);
    for (let n = first; n < track.length && isOfShade(track[n]); n++) context.lineTo(track[n].x, track[n].y);
    context.stroke();
  }
  context.globalAlpha = 1;
}
