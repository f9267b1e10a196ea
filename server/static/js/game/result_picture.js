// The own result as a picture to keep or to send to friends. It is drawn here: no server has to make or keep it.

import { avatarUrl } from "../common/assets.js";
import { element } from "../common/dom.js";
import { wearColour } from "../common/robot_colours.js";
import { dateTime, t } from "../common/words.js";

const [WIDTH, HEIGHT] = [1200, 630]; // px, as most places that show a picture of a link have it
const EDGE = 70; // px
const SHOWN = 5; // of the ranking

/**
 * What is on the picture.
 * @typedef {object} Story
 * @property {string} title "YOU WIN!"
 * @property {string} text "Your place is 1."
 * @property {string[]} stats
 * @property {import("../battle/messages.js").Player} own the player's entry in the result
 * @property {import("../battle/messages.js").Player[]} result best first
 * @property {number} battle its number
 */

/** The buttons that save the picture and, where the browser can, hand it to another program. @param {Story} story */
export function pictureButtons(story) {
  const button = (text, use) => {
    const made = element("button", { type: "button", className: "button quiet" }, text);
    made.addEventListener("click", async () => use(new File([await draw(story)], `laserbot-battle-${story.battle}.png`, { type: "image/png" })));
    return made;
  };
  const canShare = navigator.canShare?.({ files: [new File([], "result", { type: "image/png" })] }) ?? false;
  return element("p", { className: "result-picture" }, button(t("result.save_picture"), save), canShare && button(t("result.share"), share));
}

function save(file) {
  const link = element("a", { href: URL.createObjectURL(file), download: file.name });
  link.click();
  URL.revokeObjectURL(link.href);
}

async function share(file) {
  try {
    await navigator.share({ files: [file] });
  } catch (error) {
    if (error.name !== "AbortError") save(file); // which is the player's own wish
  }
}

/** @param {Story} story @returns {Promise<Blob>} PNG */
async function draw({ title, text, stats, own, result }) {
  const canvas = element("canvas", { width: WIDTH, height: HEIGHT });
  const context = canvas.getContext("2d");
  const [face] = await Promise.all([loaded(avatarUrl(own.avatar)), document.fonts.load("800 80px Oxanium")]);
  const paint = palette(result.map(({ robot }) => robot));
  const colour = paint.robots.get(own.robot);

  context.fillStyle = paint.night;
  context.fillRect(0, 0, WIDTH, HEIGHT);
  context.fillStyle = colour;
  context.fillRect(0, 0, 16, HEIGHT);

  const write = (words, x, y, size, style, weight = 600, width = WIDTH - EDGE - x) => {
    context.font = `${weight} ${size}px Oxanium, sans-serif`;
    context.fillStyle = style;
    context.fillText(words, x, y, width); // what is too long is drawn narrower
  };
  write("LaserBot Battle", EDGE, 88, 34, paint.text, 800);
  write(dateTime(new Date()), 700, 88, 26, paint.muted);

  context.beginPath();
  context.arc(EDGE + 95, 235, 95, 0, 2 * Math.PI);
  context.lineWidth = 10;
  context.strokeStyle = colour;
  context.save();
  context.clip();
  context.drawImage(face, EDGE, 140, 190, 190);
  context.restore();
  context.stroke();

  write(title, 310, 225, 84, own.place === 1 ? paint.gold : paint.text, 800);
  write(`${own.name}: ${text}`, 310, 290, 38, paint.text);
  stats.forEach((line, row) => write(line, EDGE, 410 + 42 * row, 30, paint.muted, 600, 480));
  result.slice(0, SHOWN).forEach(({ place, name, robot }, row) => {
    const y = 410 + 42 * row;
    write(`${place}.`, 640, y, 32, paint.muted, 600, 50);
    context.fillStyle = paint.robots.get(robot);
    context.beginPath();
    context.arc(712, y - 11, 12, 0, 2 * Math.PI);
    context.fill();
    write(name, 740, y, 32, name === own.name ? paint.accent : paint.text, name === own.name ? 800 : 600);
  });
  return new Promise((resolve) => canvas.toBlob(resolve, "image/png"));
}

/** The colours of the night, as common.css has them: the picture looks the same whatever the page's colours are. */
function palette(robots) {
  const probe = element("i", { className: "night", hidden: true });
  document.body.append(probe);
  const ask = (name) => {
    probe.style.color = `var(--${name})`;
    return getComputedStyle(probe).color;
  };
  const found = Object.fromEntries(["night", "text", "muted", "accent", "gold"].map((name) => [name, ask(name)]));
  const ofRobots = robots.map((robot) => {
    wearColour(probe, robot);
    return [robot, ask("robot")];
  });
  probe.remove();
  return { ...found, robots: new Map(ofRobots) };
}

async function loaded(url) {
  const image = new Image();
  image.src = url;
  await image.decode();
  return image;
}
