// One robot seen from above, painted in parts: a round chassis with the emitter in its nose, and two wheels.
// The contexts are in metres, y up, with the robot's centre at the origin and its nose along +x.

export const WHEEL = { offset: 0.06, length: 0.066, width: 0.022, tread: 0.011 }; // m

/** The shadow on the floor; it does not turn with the robot. */
export function paintShadow(context, radius) {
  const shade = context.createRadialGradient(0.006, -0.012, radius * 0.6, 0.006, -0.012, radius * 1.2);
  shade.addColorStop(0, "rgba(0, 0, 0, 0.7)");
  shade.addColorStop(1, "rgba(0, 0, 0, 0)");
  context.fillStyle = shade;
  disc(context, 0.006, -0.012, radius * 1.2);
}

/** A wheel around the origin that has rolled so far (m). */
export function paintWheel(context, rolled) {
  const { length, width, tread } = WHEEL;
  context.beginPath();
  context.roundRect(-length / 2, -width / 2, length, width, 0.006);
  context.fillStyle = "#3a4770";
  context.fill();
  context.clip();
  context.strokeStyle = "#a9b6dd";
  context.lineWidth = 0.0045;
  context.beginPath();
  for (let x = -length / 2 - tread + rolled; x < length / 2 + tread; x += tread) {
    context.moveTo(x, -width / 2);
    context.lineTo(x, width / 2);
  }
  context.stroke();
}

/** Chassis and nose; `lamp`: the emitter is on, `flash`: light falls on the robot. */
export function paintBody(context, radius, colour, lamp, flash) {
  paintChassis(context, radius * 0.7, colour, flash);
  paintNose(context, radius, colour, lamp);
}

/** Where a robot is thought to be: its rim in twelve dashes, the first of them its nose. */
export function paintOutline(context, radius, colour) {
  const dash = (Math.PI * radius) / 12;
  context.strokeStyle = colour;
  context.lineWidth = 0.009;
  context.setLineDash([dash]);
  context.lineDashOffset = dash / 2;
  context.beginPath();
  context.arc(0, 0, radius, 0, 2 * Math.PI);
  context.stroke();
  context.setLineDash([]);
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

function paintNose(context, radius, colour, lamp) {
  context.fillStyle = colour; // an arrowhead that ends at the chassis' very edge
  context.beginPath();
  context.moveTo(radius, 0);
  context.lineTo(radius * 0.45, radius * 0.55);
  context.lineTo(radius * 0.62, 0);
  context.lineTo(radius * 0.45, -radius * 0.55);
  context.closePath();
  context.fill();
  context.fillStyle = lamp ? "#fff0f4" : "#3a1024";
  context.strokeStyle = lamp ? "#ff3d6e" : "#0a0f1e";
  context.lineWidth = 0.002;
  disc(context, radius * 0.8, 0, 0.006);
  context.stroke();
}

/** The light that a hit leaves on a robot. */
export function paintHalo(context, radius) {
  const halo = context.createRadialGradient(0, 0, radius * 0.4, 0, 0, radius * 2);
  halo.addColorStop(0, "rgba(255, 120, 150, 0.5)");
  halo.addColorStop(0.45, "rgba(255, 61, 110, 0.35)");
  halo.addColorStop(1, "rgba(255, 61, 110, 0)");
  context.fillStyle = halo;
  disc(context, 0, 0, radius * 2);
}

/** One puff of smoke. */
export function paintPuff(context, radius) {
  const puff = context.createRadialGradient(0, 0, 0, 0, 0, radius);
  puff.addColorStop(0, "rgba(150, 156, 172, 0.8)");
  puff.addColorStop(0.5, "rgba(120, 126, 142, 0.4)");
  puff.addColorStop(1, "rgba(100, 106, 122, 0)");
  context.fillStyle = puff;
  disc(context, 0, 0, radius);
}

function disc(context, x, y, radius) {
  context.beginPath();
  context.arc(x, y, radius, 0, 2 * Math.PI);
  context.fill();
}
