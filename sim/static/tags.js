// The labels of all robots: painted when something changes, placed anew for each frame.

import { Avatars } from "./avatars.js";
import { layOut } from "./labels.js";
import { paintTag } from "./tag.js";

const EASE = 0.18; // of the way to its place that a label goes in a frame
const JUMP = 0.5; // m; farther than that a robot has not driven

export class Tags {
  #avatars = new Avatars();
  #painted = new Map(); // robot's name -> { key, canvas }
  #offsets = new Map(); // robot's name -> where its label stands, from the robot's centre (canvas px)

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
   */
  draw(context, entries, picture) {
    const tags = entries.map((entry) => {
      const canvas = this.#paint(entry, picture);
      return { x: entry.x, y: entry.y, radius: picture.radius * 1.35, width: canvas.width, height: canvas.height, canvas };
    });
    const places = layOut(tags, picture.width, picture.height);
    entries.forEach((entry, n) => {
      const offset = this.#ease(entry.robot.name, { x: places[n].left - entry.x, y: places[n].top - entry.y }, picture.scale);
      const left = Math.max(0, Math.min(entry.x + offset.x, picture.width - tags[n].width));
      const top = Math.max(0, Math.min(entry.y + offset.y, picture.height - tags[n].height));
      context.drawImage(tags[n].canvas, Math.round(left), Math.round(top));
    });
  }

  /** Labels glide when they give way. */
  #ease(name, wanted, scale) {
    const old = this.#offsets.get(name);
    const isNear = old && Math.hypot(wanted.x - old.x, wanted.y - old.y) < JUMP * scale;
    const offset = isNear ? { x: old.x + EASE * (wanted.x - old.x), y: old.y + EASE * (wanted.y - old.y) } : wanted;
    this.#offsets.set(name, offset);
    return offset;
  }

  #paint({ robot, player, colour, isMe }, picture) {
    const avatar = this.#avatars.get(player.avatar, () => this.#painted.clear());
    const { scale, density, width, you } = picture;
    const text = isMe ? you : player.name;
    const key = JSON.stringify([text, player.life, player.out, player.ready, player.avatar, colour, isMe, scale, density, width]);
    const old = this.#painted.get(robot.name);
    if (old?.key === key) return old.canvas;
    const canvas = paintTag(player, { text, colour, isMe, avatar, scale: scale / density, density, width: width / density });
    this.#painted.set(robot.name, { key, canvas });
    return canvas;
  }
}
