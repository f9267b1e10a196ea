// The floor and its walls: painted once for each size of the canvas.

/** Paint the ground of an arena; the context is in metres, y up. */
export function paintGround(context, { width, height }) {
  const light = context.createRadialGradient(width / 2, height / 2, 0, width / 2, height / 2, width * 0.65);
  light.addColorStop(0, "#16213f");
  light.addColorStop(0.6, "#0d1429");
  light.addColorStop(1, "#080c1a");
  context.fillStyle = light;
  context.fillRect(0, 0, width, height);
  paintGrid(context, width, height);
  paintMarks(context, width, height);
}

/** Paint its walls, likewise. */
export function paintWalls(context, { width, height, walls }) {
  const isOuter = ([x1, y1, x2, y2]) => (x1 === x2 && (x1 === 0 || x1 === width)) || (y1 === y2 && (y1 === 0 || y1 === height));
  paintTubes(context, walls.filter(isOuter), ["#2d9bff", "#2f8dff", "#a9d8ff"]);
  paintTubes(context, walls.filter((wall) => !isOuter(wall)), ["#b14dff", "#a04dff", "#ecd6ff"]);
}

function paintGrid(context, width, height) {
  for (let n = 1; n * 0.1 < width - 0.01; n++) line(context, n, n * 0.1, 0, n * 0.1, height);
  for (let n = 1; n * 0.1 < height - 0.01; n++) line(context, n, 0, n * 0.1, width, n * 0.1);
}

function line(context, n, ...[x1, y1, x2, y2]) {
  context.strokeStyle = n % 2 ? "rgba(94, 130, 220, 0.07)" : "rgba(94, 130, 220, 0.16)";
  context.lineWidth = 0.0025;
  context.beginPath();
  context.moveTo(x1, y1);
  context.lineTo(x2, y2);
  context.stroke();
}

function paintMarks(context, width, height) {
  context.strokeStyle = "rgba(45, 226, 255, 0.12)";
  context.lineWidth = 0.006;
  for (const radius of [0.2, 0.215]) {
    context.beginPath();
    context.arc(width / 2, height / 2, radius, 0, 2 * Math.PI);
    context.stroke();
  }
}

function paintTubes(context, walls, [glow, tube, core]) {
  const path = new Path2D();
  for (const [x1, y1, x2, y2] of walls) {
    path.moveTo(x1, y1);
    path.lineTo(x2, y2);
  }
  context.lineCap = context.lineJoin = "round";
  const scale = context.getTransform().a;
  context.save();
  context.shadowColor = "rgba(0, 0, 0, 0.8)"; // the wall stands on the floor
  context.shadowBlur = 0.03 * scale;
  context.shadowOffsetX = 0.008 * scale;
  context.shadowOffsetY = 0.014 * scale;
  stroke(context, path, "#0a1226", 0.022);
  context.shadowColor = glow;
  context.shadowOffsetX = context.shadowOffsetY = 0;
  context.shadowBlur = 0.035 * scale;
  stroke(context, path, tube, 0.013);
  context.restore();
  stroke(context, path, core, 0.004);
}

function stroke(context, path, colour, width) {
  context.strokeStyle = colour;
  context.lineWidth = width;
  context.stroke(path);
}
