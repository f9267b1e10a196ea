// The arena seen from above, on a canvas: floor, tracks, beams, robots, sparks. Everything is drawn in metres, y up.

import { colourOf } from "./colours.js";
import { Sparks } from "./sparks.js";
import { paintFloor } from "./floor.js";
import { paintRobot } from "./robot.js";
import { fan } from "./rays.js";

const MARGIN = 0.05; // m around the floor, for the outer walls' glow
const EMITTER = 0.06; // m ahead of a robot's centre
const TRACK_SECONDS = 2.5; // that tyre tracks are seen
const FLASH_SECONDS = 0.6;

export class Scene {
  constructor(canvas) {
    this.canvas = canvas;
    this.context = canvas.getContext("2d");
    this.sparks = new Sparks();
    this.known = new Map(); // name -> what the picture remembers of a robot
    this.arena = null;
  }

  /** `arena` is the view's first message. */
  build(arena) {
    this.arena = arena;
    this.known.clear();
    this.resize();
  }

  /** Fit the floor into the canvas' parent at the screen's resolution. */
  resize() {
    if (!this.arena) return;
    const room = this.canvas.parentElement.getBoundingClientRect();
    const [width, height] = [this.arena.width + 2 * MARGIN, this.arena.height + 2 * MARGIN];
    const scale = Math.min(room.width / width, room.height / height);
    const density = window.devicePixelRatio || 1;
    this.canvas.style.width = `${width * scale}px`;
    this.canvas.style.height = `${height * scale}px`;
    this.canvas.width = Math.max(1, Math.round(width * scale * density));
    this.canvas.height = Math.max(1, Math.round(height * scale * density));
    this.scale = scale * density;
    this.floor = new OffscreenCanvas(this.canvas.width, this.canvas.height);
    const context = this.floor.getContext("2d");
    this.toMetres(context);
    paintFloor(context, this.arena);
  }

  toMetres(context) {
    context.setTransform(this.scale, 0, 0, -this.scale, MARGIN * this.scale, (this.arena.height + MARGIN) * this.scale);
  }

  /** Draw `robots` (poses of the view) at `now` (s). */
  draw(robots, now) {
    if (!this.arena) return;
    const context = this.context;
    context.setTransform(1, 0, 0, 1, 0, 0);
    context.clearRect(0, 0, this.canvas.width, this.canvas.height);
    context.drawImage(this.floor, 0, 0);
    this.toMetres(context);
    for (const robot of robots) this.remember(robot, now);
    for (const name of this.known.keys()) if (!robots.some((robot) => robot.name === name)) this.known.delete(name);
    for (const robot of robots) this.drawTracks(context, robot, now);
    for (const robot of robots) {
      const memory = this.known.get(robot.name);
      const flash = robot.lit ? 1 : Math.max(0, 1 - (now - memory.hitAt) / FLASH_SECONDS);
      paintRobot(context, robot, this.arena.robot_radius, colourOf(robot), memory.wheels, flash, now);
    }
    context.globalCompositeOperation = "lighter";
    for (const robot of robots) if (robot.beam) this.drawBeam(context, robot, robots);
    this.sparks.draw(context, now);
    context.globalCompositeOperation = "source-over";
  }

  /** Follow a robot from picture to picture: its tracks, how its wheels turn, new hits. */
  remember(robot, now) {
    const { x, y, heading } = robot;
    const old = this.known.get(robot.name) ?? { x, y, heading, hits: robot.hits, hitAt: -Infinity, wheels: [0, 0], track: [] };
    const turn = Math.atan2(Math.sin(heading - old.heading), Math.cos(heading - old.heading));
    const ahead = (x - old.x) * Math.cos(heading) + (y - old.y) * Math.sin(heading);
    const wheels = [old.wheels[0] + ahead - turn * EMITTER, old.wheels[1] + ahead + turn * EMITTER];
    const track = old.track.filter((point) => now - point.time < TRACK_SECONDS);
    const last = track.at(-1);
    if (!last || Math.hypot(last.x - x, last.y - y) > 0.008) track.push({ x, y, time: now });
    let { hitAt } = old;
    if (robot.hits > old.hits) {
      hitAt = now;
      this.sparks.burst(robot, this.arena.robot_radius, this.arena.height, now);
    }
    this.known.set(robot.name, { x, y, heading, hits: robot.hits, hitAt, wheels, track });
  }

  drawTracks(context, robot, now) {
    const { track } = this.known.get(robot.name);
    context.strokeStyle = colourOf(robot);
    context.lineWidth = 0.012;
    context.lineCap = "round";
    for (let n = 1; n < track.length; n++) {
      context.globalAlpha = 0.28 * (1 - (now - track[n].time) / TRACK_SECONDS);
      context.beginPath();
      context.moveTo(track[n - 1].x, track[n - 1].y);
      context.lineTo(track[n].x, track[n].y);
      context.stroke();
    }
    context.globalAlpha = 1;
  }

  drawBeam(context, robot, robots) {
    const { beam_range: range, beam_half_angle: half, robot_radius: radius, walls } = this.arena;
    const x = robot.x + EMITTER * Math.cos(robot.heading);
    const y = robot.y + EMITTER * Math.sin(robot.heading);
    const others = robots.filter((other) => other.name !== robot.name);
    const glow = context.createRadialGradient(x, y, 0, x, y, range);
    glow.addColorStop(0, "rgba(255, 80, 120, 0.55)");
    glow.addColorStop(0.35, "rgba(255, 50, 95, 0.26)");
    glow.addColorStop(0.85, "rgba(255, 40, 90, 0.13)");
    glow.addColorStop(1, "rgba(255, 40, 90, 0)");
    context.fillStyle = glow;
    for (const width of [1, 0.66, 0.34, 0.1]) { // brighter towards the axis
      const rays = fan(x, y, robot.heading, half * width, 40, range, walls, others, radius);
      context.beginPath();
      context.moveTo(x, y);
      for (const { angle, distance } of rays) context.lineTo(x + distance * Math.cos(angle), y + distance * Math.sin(angle));
      context.fill();
      if (width === 1) this.drawImpacts(context, x, y, rays);
    }
  }

  /** Light on the chassis that it falls on. */
  drawImpacts(context, x, y, rays) {
    context.save();
    context.lineCap = "round";
    context.lineWidth = 0.01;
    context.strokeStyle = "rgba(255, 190, 205, 0.9)";
    context.shadowColor = "#ff3d6e";
    context.shadowBlur = 0.05 * this.scale;
    context.beginPath();
    rays.forEach(({ angle, distance, robot }, n) => {
      if (!robot) return;
      const point = [x + distance * Math.cos(angle), y + distance * Math.sin(angle)];
      if (rays[n - 1]?.robot === robot) context.lineTo(...point);
      else context.moveTo(...point);
    });
    context.stroke();
    context.restore();
  }
}
