// One robot seen from above: two wheels, a round chassis, the emitter in its nose, its ID.

import { write } from "./text.js";

const WHEEL = { offset: 0.06, length: 0.066, width: 0.022, tread: 0.011 }; // m

/**
 * Paint `robot` (a pose of the view). `wheels` = how far (m) the left and right wheel have rolled,
 * `flash` = 1 while it is lit, falling to 0 afterwards.
 */
export function paintRobot(context, robot, radius, colour, wheels, flash, now) {
  context.save();
  context.translate(robot.x, robot.y);
  paintShadow(context, radius);
  context.save();
  context.rotate(robot.heading);
  paintWheel(context, WHEEL.offset, wheels[0]);
  paintWheel(context, -WHEEL.offset, wheels[1]);
  paintChassis(context, radius * 0.7, colour, flash);
  paintNose(context, radius, colour, robot.beam);
  context.restore();
  paintNumber(context, robot.id ?? "?", radius, flash);
  if (flash > 0) paintHalo(context, radius, flash, robot.lit ? 0.85 + 0.15 * Math.sin(now * 60) : 1);
  context.restore();
}

function paintShadow(context, radius) {
  const shade = context.createRadialGradient(0.006, -0.012, radius * 0.6, 0.006, -0.012, radius * 1.2);
  shade.addColorStop(0, "rgba(0, 0, 0, 0.7)");
  shade.addColorStop(1, "rgba(0, 0, 0, 0)");
  context.fillStyle = shade;
  disc(context, 0.006, -0.012, radius * 1.2);
}

function paintWheel(context, y, rolled) {
  const { length, width, tread } = WHEEL;
  context.save();
  context.beginPath();
  context.roundRect(-length / 2, y - width / 2, length, width, 0.006);
  context.fillStyle = "#3a4770";
  context.fill();
  context.clip();
  context.strokeStyle = "#a9b6dd";
  context.lineWidth = 0.0045;
  const start = ((rolled % tread) + tread) % tread;
  context.beginPath();
  for (let x = -length / 2 - tread + start; x < length / 2 + tread; x += tread) {
    context.moveTo(x, y - width / 2);
    context.lineTo(x, y + width / 2);
  }
  context.stroke();
  context.restore();
}

function paintChassis(context, radius, colour, flash) {
  const metal = context.createRadialGradient(radius * 0.3, radius * 0.2, 0, 0, 0, radius);
  metal.addColorStop(0, flash ? "#7a3350" : "#33415f");
  metal.addColorStop(0.75, flash ? "#45162c" : "#1a2440");
  metal.addColorStop(1, "#0d1426");
  context.save();
  context.shadowColor = colour;
  context.shadowBlur = 0.022 * Math.hypot(context.getTransform().a, context.getTransform().b);
  context.fillStyle = metal;
  disc(context, 0, 0, radius);
  context.strokeStyle = colour;
  context.lineWidth = 0.007;
  context.stroke();
  context.restore();
  context.strokeStyle = "rgba(255, 255, 255, 0.1)";
  context.lineWidth = 0.002;
  context.beginPath();
  context.arc(0, 0, radius * 0.74, 0, 2 * Math.PI);
  context.stroke();
}

function paintNose(context, radius, colour, beam) {
  context.fillStyle = colour; // an arrowhead that ends at the chassis' very edge
  context.beginPath();
  context.moveTo(radius, 0);
  context.lineTo(radius * 0.45, radius * 0.55);
  context.lineTo(radius * 0.62, 0);
  context.lineTo(radius * 0.45, -radius * 0.55);
  context.closePath();
  context.fill();
  context.fillStyle = beam ? "#fff0f4" : "#3a1024";
  context.strokeStyle = beam ? "#ff3d6e" : "#0a0f1e";
  context.lineWidth = 0.002;
  disc(context, radius * 0.8, 0, 0.006);
  context.stroke();
}

function paintNumber(context, text, radius, flash) {
  context.fillStyle = flash ? "#fff" : "#eaf2ff";
  write(context, text, 0, 0, radius * 0.74);
}

function paintHalo(context, radius, flash, flicker) {
  context.save();
  context.globalCompositeOperation = "lighter";
  const halo = context.createRadialGradient(0, 0, radius * 0.4, 0, 0, radius * 2);
  halo.addColorStop(0, `rgba(255, 120, 150, ${0.5 * flash * flicker})`);
  halo.addColorStop(0.45, `rgba(255, 61, 110, ${0.35 * flash * flicker})`);
  halo.addColorStop(1, "rgba(255, 61, 110, 0)");
  context.fillStyle = halo;
  disc(context, 0, 0, radius * 2);
  context.strokeStyle = `rgba(255, 210, 220, ${flash * flash})`; // a shock wave runs outwards
  context.lineWidth = 0.006 * flash;
  context.beginPath();
  context.arc(0, 0, radius * (1 + 0.9 * (1 - flash)), 0, 2 * Math.PI);
  context.stroke();
  context.restore();
}

function disc(context, x, y, radius) {
  context.beginPath();
  context.arc(x, y, radius, 0, 2 * Math.PI);
  context.fill();
}
