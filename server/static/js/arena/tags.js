// The labels of all robots: painted when something changes, placed anew for each frame.

import { Avatars } from "./avatars.js";
import { layOut } from "./labels.js";
import { paintTag } from "./tag.js";

const EASE = 0.084; // s in which a label goes two thirds of the way to its place
const LONGEST = 0.05; // s between two pictures; after more, a label that has stood still does not jump
const THERE = 0.5; // canvas px; nearer to its place it stands
const JUMP = 0.5; // m; farther than that a robot has not driven

export class Tags {
  #avatars = new Avatars();
  #painted = new Map(); // robot's name -> { key, label }
  #offsets = new Map(); // robot's name -> where its label stands, from the robot's centre (canvas px)
  #drawnAt = -Infinity; // s

  /** Whether the next picture would show other labels though nothing else has changed: they glide, or an avatar has come. */
  isUnfinished = false;

  clear() {
    this.#painted.clear();
    this.#offsets.clear();
  }

  /**
   * Draw the labels; the context is in canvas pixels.
   * @param {{robot: object, player: object, colour: string, isMe: boolean, x: number, y: number}[]} entries with the
   *   robot's centre in canvas pixels; the last is on top
   * @param {{scale: number, density: number, width: number, height: number, radius: number, you: string}} picture in canvas
   *   pixels, `scale` for a metre, `density` for a CSS pixel
   * @param {number} now s
   */
  draw(context, entries, picture, now) {
    this.isUnfinished = false;
    const tags = entries.map((entry) => {
      const label = this.#paint(entry, picture);
      return { x: entry.x, y: entry.y, radius: picture.radius * 1.35, width: label.width, height: label.height, label };
    });
    const wanted = layOut(tags, picture.width, picture.height);
    const part = 1 - Math.exp(-Math.min(LONGEST, now - this.#drawnAt) / EASE); // of the way that is left
    this.#drawnAt = now;
    const places = entries.map((entry, n) => this.#glide(entry, tags[n], wanted[n], picture, part));
    entries.forEach((entry, n) => drawLead(context, entry, tags[n], places[n], picture.density));
    places.forEach(({ left, top }, n) => context.drawImage(tags[n].label, Math.round(left), Math.round(top)));
  }

  /** Where a label stands now on its way to the wanted place, inside the picture. */
  #glide({ robot, x, y }, { width, height }, { left, top }, picture, part) {
    const offset = this.#ease(robot.name, { x: left - x, y: top - y }, JUMP * picture.scale, part);
    return {
      left: Math.max(0, Math.min(x + offset.x, picture.width - width)),
      top: Math.max(0, Math.min(y + offset.y, picture.height - height)),
    };
  }

  /** Labels glide when they give way. */
  #ease(name, wanted, near, part) {
    const old = this.#offsets.get(name);
    const way = old ? Math.hypot(wanted.x - old.x, wanted.y - old.y) : 0;
    const isThere = !old || way > near || way * (1 - part) < THERE;
    const offset = isThere ? wanted : { x: old.x + part * (wanted.x - old.x), y: old.y + part * (wanted.y - old.y) };
    this.isUnfinished ||= !isThere;
    this.#offsets.set(name, offset);
    return offset;
  }

  #paint({ robot, player, colour, isMe }, picture) {
    const avatar = this.#avatars.get(player.avatar, () => {
      this.#painted.clear();
      this.isUnfinished = true;
    });
    const { scale, density, width, you } = picture;
    const text = isMe ? you : player.name;
    const key = JSON.stringify([text, player.life, player.out, player.ready, player.avatar, colour, isMe, scale, density, width]);
    const old = this.#painted.get(robot.name);
    if (old?.key === key) return old.label;
    const label = paintTag(player, { text, colour, isMe, avatar, scale: scale / density, density, width: width / density });
    this.#painted.set(robot.name, { key, label });
    return label;
  }
}

/** A line to the robot from a label that has given way. */
function drawLead(context, { x, y, colour }, { radius, width, height }, { left, top }, density) {
  const near = { x: Math.max(left, Math.min(x, left + width)), y: Math.max(top, Math.min(y, top + height)) };
  const distance = Math.hypot(near.x - x, near.y - y);
  if (distance < 1.3 * radius) return;
  context.strokeStyle = colour;
  context.lineWidth = 1.5 * density;
  context.beginPath();
  context.moveTo(x + ((near.x - x) * radius) / distance, y + ((near.y - y) * radius) / distance);
  context.lineTo(near.x, near.y);
  context.stroke();
}
