// Lays a camera's picture flat as a page does, for a test in Python: node flat_picture.mjs PICTURE FLAT, the former in RGBA;
// stdin has {"view": a laser_bot_battle/OverheadView, "frame": ..., "level": m}; stdout gets {"width": ..., "height": ...}.

import { readFileSync, writeFileSync } from "node:fs";
import { flatten, rectify } from "../../server/static/js/overhead/rectify.js";
import { readSight } from "../../server/static/js/overhead/sight.js";

const [, , picture, output] = process.argv;
const { view, frame, level } = JSON.parse(readFileSync(0, "utf8"));
const flat = flatten(readSight(view), frame, level);
const pixels = new Uint32Array(flat.width * flat.height);
const bytes = new Uint8Array(readFileSync(picture)); // a copy: its pixels begin where a Uint32Array may
rectify(new Uint32Array(bytes.buffer), flat, pixels);
writeFileSync(output, new Uint8Array(pixels.buffer));
console.log(JSON.stringify({ width: flat.width, height: flat.height }));
