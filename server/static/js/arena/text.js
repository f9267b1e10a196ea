// Words on a canvas that is in metres, y up.

const PIXELS = 100; // browsers round tiny fonts: write big and scale down

/** Write `text` upright, centred at (x, y), `size` m high, in the present fill style. */
export function write(context, text, x, y, size) {
  context.save();
  context.translate(x, y);
  context.scale(size / PIXELS, -size / PIXELS);
  context.font = `800 ${PIXELS}px system-ui, sans-serif`;
  context.textAlign = "center";
  context.textBaseline = "middle";
  context.fillText(text, 0, PIXELS * 0.08); // digits and capitals stand above the middle
  context.restore();
}
