// A player's label over the robot: picture, name and life on a small plate.

const FONT = { least: 11, most: 17, share: 0.05 }; // CSS px; `share` of a metre in the picture
const NAME_SHARE = 0.22; // of the picture's width, the most for a name
const INK = { plate: "rgba(5, 8, 18, 0.82)", text: "#f2f6ff", out: "#aab3c8", onColour: "#05070f", rail: "rgba(140, 155, 195, 0.35)" };

/** The size of the letters (CSS px) in a picture with so many CSS px for a metre. */
export const fontSize = (scale) => Math.round(Math.max(FONT.least, Math.min(FONT.most, FONT.share * scale)));

/** The colour of a life bar. */
export const lifeColour = (life) => (life > 50 ? "#3dffa2" : life > 25 ? "#ffc53d" : "#ff3d6e");

/**
 * Paint a label.
 * @param {import("./roles.js").Player} player
 * @param {{text: string, colour: string, isMe: boolean, avatar: CanvasImageSource|null, scale: number, density: number,
 *   width: number}} look `scale` = CSS px for a metre, `density` = canvas pixels for a CSS px, `width` of the picture (CSS px)
 * @returns {ImageBitmap} in canvas pixels
 */
export function paintTag(player, look) {
  const size = fontSize(look.scale);
  const font = `700 ${size}px system-ui, -apple-system, "Segoe UI", Roboto, "Noto Sans", sans-serif`;
  const round = Math.round(size * 1.9); // the picture's diameter, and the height inside
  const text = shorten(look.text, font, Math.max(48, NAME_SHARE * look.width));
  const pad = Math.round(size * 0.5);
  const start = look.avatar ? round + pad : pad;
  const width = Math.ceil(start + Math.max(text.width, size * 3.2) + pad) + 4;
  const height = round + 4;
  const canvas = new OffscreenCanvas(Math.ceil(width * look.density), Math.ceil(height * look.density));
  const context = canvas.getContext("2d");
  context.scale(look.density, look.density);
  context.translate(2, 2);
  const inner = width - 4;
  context.beginPath();
  context.roundRect(0, 0, inner, round, round / 2);
  context.fillStyle = look.isMe && !player.out ? look.colour : INK.plate;
  context.fill();
  context.lineWidth = 1.5;
  context.strokeStyle = player.out ? "#6b7489" : look.colour;
  context.stroke();
  context.font = font;
  context.textBaseline = "middle";
  context.fillStyle = inkOf(player, look);
  const hasBar = player.ready || player.out;
  context.fillText(text.text, start, hasBar ? round * 0.37 : round * 0.53);
  if (hasBar) paintLife(context, player, look, { left: start, top: round * 0.7, width: inner - start - pad, height: Math.max(3, round * 0.16) });
  if (look.avatar) paintAvatar(context, look, player.out, round);
  return canvas.transferToImageBitmap();
}

function inkOf(player, look) {
  if (player.out) return INK.out;
  return look.isMe ? INK.onColour : INK.text;
}

function paintLife(context, player, look, bar) {
  const fill = (width, colour) => {
    context.beginPath();
    context.roundRect(bar.left, bar.top, width, bar.height, bar.height / 2);
    context.fillStyle = colour;
    context.fill();
  };
  if (look.isMe && !player.out) { // a dark bed: its plate is as bright as the bar
    context.beginPath();
    context.roundRect(bar.left - 1.5, bar.top - 1.5, bar.width + 3, bar.height + 3, bar.height);
    context.fillStyle = INK.onColour;
    context.fill();
  }
  fill(bar.width, INK.rail);
  if (player.life > 0 && !player.out) fill(Math.max(bar.height, (bar.width * player.life) / 100), lifeColour(player.life));
}

function paintAvatar(context, look, out, round) {
  context.save();
  context.beginPath();
  context.arc(round / 2, round / 2, round / 2 - 0.5, 0, 2 * Math.PI);
  context.save();
  context.clip();
  context.drawImage(look.avatar, 0, 0, round, round);
  if (out) {
    context.globalCompositeOperation = "saturation"; // grey
    context.fillStyle = "#777";
    context.fillRect(0, 0, round, round);
  }
  context.restore();
  context.lineWidth = 2;
  context.strokeStyle = out ? "#6b7489" : look.colour;
  context.stroke();
  context.restore();
}

const ruler = new OffscreenCanvas(1, 1).getContext("2d");

/** `text`, with its end left out if it is wider than `most`, and its width. */
function shorten(text, font, most) {
  ruler.font = font;
  const widthOf = (words) => ruler.measureText(words).width;
  if (widthOf(text) <= most) return { text, width: widthOf(text) };
  const letters = [...text];
  while (letters.length > 1 && widthOf(`${letters.join("")}…`) > most) letters.pop();
  const short = `${letters.join("")}…`;
  return { text: short, width: widthOf(short) };
}
