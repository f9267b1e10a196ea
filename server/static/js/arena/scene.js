// The arena seen from above, in one pass over one canvas: floor, tracks, robots, beams, sparks, smoke, labels.

import { colourOf, OUT } from "./colours.js";
import { drawBeam } from "./beams.js";
import { drawMark, isCalling } from "./mark.js";
import { drawSmoke } from "./smoke.js";
import { drawTrack } from "./tracks.js";
import { EMITTER, Memory } from "./memory.js";
import { DRIFT, isDue, isOther, MOTION, REST } from "./pace.js";
import { drawPlaces } from "./places.js";
import { paintGround, paintWalls } from "./floor.js";
import { Sparks } from "./sparks.js";
import { Sprites } from "./sprites.js";
import { Tags } from "./tags.js";

export const MARGIN = 0.05; // m around the floor, for the outer walls' glow
const DIM = 0.5; // alpha of a robot that nobody plays
const VEILED = 0.35; // of one that is not seen
const NIGHT = "#05070f";
const DUSK = "rgba(5, 7, 15, 0.4)"; // over a real floor: names and light are made for a dark one

/** What is drawn of a robot that nobody is known to play. */
const NOBODY = { player: null, isMe: false, out: false };

export class Scene {
  #canvas;
  #context;
  #memory = new Memory();
  #sparks = new Sparks();
  #tags = new Tags();
  #arena = null;
  #floor; // drawn
  #walls; // alone, for the real floor
  #realFloor = null;
  #sprites;
  #room = { width: 0, height: 0 }; // CSS px
  #density = 0; // canvas pixels for a CSS px
  #share = 1; // of its size at which the page shows the canvas
  #scale = 0; // canvas pixels for a metre
  #places = [];
  #drawn = null; // the robots on the canvas; null: something else has changed
  #effects = null; // of the last picture
  #drawnAt = -Infinity; // s
  #pace = REST; // of the last look

  constructor(canvas) {
    this.#canvas = canvas;
    this.#context = canvas.getContext("2d", { alpha: false });
  }

  /** Another floor. @param {import("./positions.js").Floor} arena */
  build(arena) {
    this.#arena = arena;
    this.#memory.clear();
    this.#density = 0;
    this.#drawn = null;
  }

  /** Hills, and what lies on the floor. @param {import("../battle/messages.js").Place[]} places */
  set places(places) {
    this.#places = places;
    this.#drawn = null;
  }

  /** What is under the robots instead of the drawn floor, which it shows with a margin of MARGIN. @param {OffscreenCanvas|null} picture */
  set realFloor(picture) {
    this.#realFloor = picture;
    this.#drawn = null;
  }

  /** Fit the floor into so much room (CSS px). */
  resize(width, height) {
    this.#room = { width, height };
    this.#density = 0;
    this.#drawn = null;
  }

  /** At how much of its size the page shows the canvas. @param {number} share */
  set share(share) {
    this.#share = share;
    this.#drawn = null;
  }

  /** Something else than the robots' places has changed: the next picture is drawn in any case. */
  renew() {
    this.#drawn = null;
  }

  /** Get the canvas ready for so many pixels for a CSS px; the size in CSS px stays. */
  #prepare(density) {
    if (density === this.#density) return;
    this.#density = density;
    const [width, height] = [this.#arena.width + 2 * MARGIN, this.#arena.height + 2 * MARGIN];
    const scale = Math.min(this.#room.width / width, this.#room.height / height);
    this.#canvas.style.width = `${width * scale}px`;
    this.#canvas.style.height = `${height * scale}px`;
    this.#canvas.width = Math.max(1, Math.round(width * scale * density));
    this.#canvas.height = Math.max(1, Math.round(height * scale * density));
    this.#scale = scale * density;
    this.#floor = this.#painted((context) => {
      context.fillStyle = NIGHT;
      context.fillRect(0, 0, this.#canvas.width, this.#canvas.height);
      this.#toMetres(context);
      paintGround(context, this.#arena);
      paintWalls(context, this.#arena);
    });
    this.#walls = null;
    this.#sprites = new Sprites(this.#scale, this.#arena.robot_radius);
    this.#tags.clear();
  }

  /** A layer as large as the canvas. */
  #painted(paint) {
    const layer = new OffscreenCanvas(this.#canvas.width, this.#canvas.height);
    paint(layer.getContext("2d"));
    return layer.transferToImageBitmap();
  }

  #drawFloor(context) {
    if (!this.#realFloor) {
      context.drawImage(this.#floor, 0, 0);
      return;
    }
    this.#walls ??= this.#painted((layer) => {
      this.#toMetres(layer);
      paintWalls(layer, this.#arena);
    });
    const { width, height } = this.#canvas;
    context.fillStyle = NIGHT; // where the camera sees nothing
    context.fillRect(0, 0, width, height);
    context.drawImage(this.#realFloor, 0, 0, width, height);
    context.fillStyle = DUSK;
    context.fillRect(0, 0, width, height);
    context.drawImage(this.#walls, 0, 0);
  }

  #toMetres(context) {
    context.setTransform(this.#scale, 0, 0, -this.#scale, MARGIN * this.#scale, (this.#arena.height + MARGIN) * this.#scale);
  }

  /** Where a point of the floor is, in canvas pixels. */
  #toPixels({ x, y }) {
    return { x: (x + MARGIN) * this.#scale, y: (this.#arena.height + MARGIN - y) * this.#scale };
  }

  /**
   * Draw a picture if it would be another one than that on the canvas.
   * @param {object[]} robots poses, each with `beam` and `hits`
   * @param {import("./roles.js").Roles} roles who plays them
   * @param {{glow: number, smoke: number, sparks: number, tracks: boolean, density: number}} effects
   * @param {boolean} still whoever looks wants no motion that means nothing
   * @param {number} now s
   * @returns {number} pictures a second that are worth drawing while no robot moves
   */
  show(robots, roles, effects, still, now) {
    if (!this.#arena || !this.#room.width || !this.#room.height) return REST;
    const pace = this.#paceOf(roles, effects, still, now);
    const isOver = pace === REST && this.#pace !== REST; // the picture after the last one of an effect is that without it
    const isDrawn = isOver || isDue(pace, now - this.#drawnAt) || this.#isNews(robots, effects);
    if (isDrawn) this.#draw(robots, roles, effects, still, now);
    this.#pace = isDrawn ? this.#paceOf(roles, effects, still, now) : pace; // a hit may have been drawn
    return this.#pace;
  }

  /** What goes on by itself. */
  #paceOf(roles, effects, still, now) {
    const isLit = this.#drawn?.some((robot) => this.#memory.flash(robot, now) > 0);
    const isCalled = roles.drives && isCalling(roles.sinceStart(now));
    if (isLit || isCalled || this.#sparks.isFlying(now) || this.#tags.isUnfinished) return MOTION;
    const drifts = (roles.smokes && effects.smoke > 0 && !still) || (effects.tracks && this.#memory.hasTracks);
    return drifts ? DRIFT : REST;
  }

  #isNews(robots, effects) {
    return !this.#drawn || effects !== this.#effects || isOther(this.#drawn, robots, this.#arena, this.#scale);
  }

  #draw(robots, roles, effects, still, now) {
    [this.#drawn, this.#effects, this.#drawnAt] = [robots, effects, now];
    this.#prepare(this.#share * Math.min(window.devicePixelRatio || 1, effects.density));
    const context = this.#context;
    context.setTransform(1, 0, 0, 1, 0, 0);
    this.#drawFloor(context);
    for (const robot of this.#memory.follow(robots, now)) {
      this.#sparks.burst(robot, this.#arena.robot_radius, this.#arena.height, still ? 0 : effects.sparks, now);
    }
    const shown = robots.map((robot) => this.#look(robot, roles, now));
    this.#toMetres(context);
    drawPlaces(context, this.#places);
    if (effects.tracks) for (const each of shown) if (!each.out) drawTrack(context, each.remembered.track, each.colour, now);
    for (const each of shown) if (each.isMe) drawMark(context, each.robot, this.#arena.robot_radius, each.colour, roles.sinceStart(now), still);
    for (const each of shown) this.#drawRobot(context, each);
    this.#drawLight(context, robots, shown, effects, roles.words.hit, still, now);
    context.setTransform(1, 0, 0, 1, 0, 0);
    const smoking = shown.filter((each) => each.out);
    for (const each of smoking) {
      const place = { ...each.pixels, scale: this.#scale };
      drawSmoke(context, this.#sprites.puff(), place, effects.smoke, still ? 0 : now + (each.robot.id ?? 0));
    }
    this.#drawTags(context, shown, roles, now);
  }

  #look(robot, roles, now) {
    const role = roles.of(robot) ?? NOBODY;
    const colour = role.player?.colour ?? colourOf(robot);
    return {
      robot,
      ...role,
      colour: role.out ? OUT : colour,
      flash: this.#memory.flash(robot, now),
      remembered: this.#memory.of(robot),
      pixels: this.#toPixels(robot),
      alpha: (roles.known && !role.player ? DIM : 1) * (robot.covered ? VEILED : 1),
    };
  }

  #drawRobot(context, { robot, player, out, colour, flash, remembered, pixels, alpha }) {
    const sprites = this.#sprites;
    const [cos, sin] = [Math.cos(robot.heading), Math.sin(robot.heading)];
    const put = (sprite, ahead = 0, aside = 0) =>
      context.drawImage(sprite, ahead * this.#scale - sprite.width / 2, -aside * this.#scale - sprite.height / 2);
    context.globalAlpha = alpha;
    context.setTransform(1, 0, 0, 1, pixels.x, pixels.y);
    put(sprites.shadow());
    context.setTransform(cos, -sin, sin, cos, pixels.x, pixels.y);
    put(sprites.wheel(remembered.wheels[0]), 0, EMITTER);
    put(sprites.wheel(remembered.wheels[1]), 0, -EMITTER);
    put(sprites.body(colour, robot.beam, flash > 0));
    context.globalAlpha = robot.covered ? 1 : alpha;
    if (robot.covered) put(sprites.outline(colour));
    context.setTransform(1, 0, 0, 1, pixels.x, pixels.y);
    put(sprites.number(robot.id ?? "?"));
    if (player?.doubleDamage && !out) put(sprites.rays());
    if (player?.shield && !out) put(sprites.shield());
    context.globalAlpha = 1;
  }

  #drawLight(context, robots, shown, effects, word, still, now) {
    const { robot_radius: radius } = this.#arena;
    context.globalCompositeOperation = "lighter";
    context.setTransform(1, 0, 0, 1, 0, 0);
    const halo = this.#sprites.halo();
    for (const { flash, pixels } of shown) {
      if (flash <= 0) continue;
      context.globalAlpha = flash;
      context.drawImage(halo, pixels.x - halo.width / 2, pixels.y - halo.height / 2);
    }
    context.globalAlpha = 1;
    this.#toMetres(context);
    for (const { robot, flash } of shown) if (flash > 0 && !still) drawShock(context, robot, radius, flash);
    for (const robot of robots) if (robot.beam) drawBeam(context, robot, robots, this.#arena, effects.glow);
    this.#sparks.draw(context, now, word, still);
    context.globalCompositeOperation = "source-over";
  }

  #drawTags(context, shown, roles, now) {
    const played = shown.filter(({ player }) => player);
    const entries = played.sort((one, other) => one.isMe - other.isMe); // the own one on top
    this.#tags.draw(
      context,
      entries.map(({ robot, player, colour, isMe, pixels }) => ({ robot, player, colour, isMe, ...pixels })),
      {
        scale: this.#scale,
        density: this.#density,
        width: this.#canvas.width,
        height: this.#canvas.height,
        radius: this.#arena.robot_radius * this.#scale,
        you: roles.words.you,
      },
      now,
    );
  }
}

/** A wave runs outwards from a robot that has been hit. */
function drawShock(context, { x, y }, radius, flash) {
  context.strokeStyle = `rgba(255, 120, 150, ${flash * flash})`;
  context.lineWidth = 0.006 * flash;
  context.beginPath();
  context.arc(x, y, radius * (1 + 0.9 * (1 - flash)), 0, 2 * Math.PI);
  context.stroke();
}
