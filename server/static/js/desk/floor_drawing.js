// The floor that is being changed, as a drawing: painted as on all pages, and over it what can be taken hold of.

import { paintGround, paintWalls } from "../arena/floor.js";
import { drawPlaces } from "../arena/places.js";
import { setText } from "../common/dom.js";
import { t } from "../common/words.js";
import * as plans from "./floor_plan.js";
import { nameOf } from "./floor_words.js";

const SVG = "http://www.w3.org/2000/svg";
export const MARGIN = 0.25; // m around the floor, where its tags lie
const CM = 100; // units of the drawing in a metre
const TAG = 0.1; // m
const [HOLD, REACH, GRIP] = [22, 14, 7]; // px: how near a finger must come to a handle and to a thing, and what is seen of a handle
const STEP = 0.01; // m by an arrow key; ten times as much with Shift
const ARROWS = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] };
const [HILL, REPAIR] = [0, 1]; // kinds of laser_bot_battle/Place; a pick-up is drawn as the first that lies there

export class FloorDrawing {
  #canvas;
  #svg;
  #on;
  #plan = null;
  #selected = null;
  #wrong = new Set();
  #tags = [];
  #realFloor = null;
  #scale = 1; // px for a metre
  #drag = null;
  #drags = 0;

  /**
   * @param {HTMLElement} box with a <canvas> and an <svg>
   * @param {{select: (thing: plans.Thing|null) => void, change: (plan: plans.Plan, key: string) => void, remove: (thing: plans.Thing) => void}} on
   */
  constructor(box, on) {
    [this.#canvas, this.#svg] = box.children;
    this.#on = on;
    new ResizeObserver(() => this.#plan && this.#draw(true)).observe(box);
    this.#svg.addEventListener("pointerdown", (event) => this.#take(event));
    this.#svg.addEventListener("pointermove", (event) => this.#pull(event));
    for (const end of ["pointerup", "pointercancel"]) this.#svg.addEventListener(end, () => (this.#drag = null));
    this.#svg.addEventListener("focusin", ({ target }) => this.#held(target) && on.select(this.#held(target).thing));
    this.#svg.addEventListener("keydown", (event) => this.#press(event));
  }

  /**
   * @param {plans.Plan} plan
   * @param {plans.Thing|null} selected
   * @param {Set<string>} wrong keys of the things that cannot stay so
   * @param {{number: number, x: number, y: number}[]} tags around the floor
   */
  show(plan, selected, wrong, tags) {
    const isNew = this.#plan !== plan;
    [this.#plan, this.#selected, this.#wrong, this.#tags] = [plan, selected, wrong, tags];
    this.#draw(isNew);
  }

  /** What lies under the things instead of the drawn ground, with MARGIN around the floor. @param {OffscreenCanvas|null} picture */
  set realFloor(picture) {
    this.#realFloor = picture;
    if (this.#plan) this.#draw(true);
  }

  #draw(paints) {
    const plan = this.#plan;
    if (!plans.hasSize(plan)) return; // until the field is right again
    this.#svg.setAttribute("viewBox", `0 0 ${(plan.width + 2 * MARGIN) * CM} ${(plan.height + 2 * MARGIN) * CM}`);
    this.#svg.parentElement.style.aspectRatio = `${plan.width + 2 * MARGIN} / ${plan.height + 2 * MARGIN}`;
    if (paints) this.#paint();
    const things = plans.thingsOf(plan).filter((thing) => plans.isPlaced(plan, thing));
    const wanted = this.#tags.map((tag) => this.#tag(tag));
    for (const thing of things) {
      wanted.push(this.#thing(thing, this.#wrong.has(plans.keyOf(thing))));
      if (plans.isSame(thing, this.#selected)) wanted.push(...plans.handlesOf(plan, thing).map((handle) => this.#handle(thing, handle)));
    }
    [...this.#svg.children].filter((old) => !wanted.includes(old)).forEach((old) => old.remove());
    wanted.forEach((one, n) => this.#svg.children[n] !== one && this.#svg.insertBefore(one, this.#svg.children[n] ?? null)); // what stays in place keeps the focus
  }

  /** Give a thing the focus. @param {plans.Thing} thing */
  focus(thing) {
    this.#find(plans.keyOf(thing))?.focus();
  }

  /** What lies under the things. */
  #paint() {
    const { width, height } = this.#plan;
    const box = this.#canvas.parentElement;
    const density = window.devicePixelRatio || 1;
    this.#scale = box.clientWidth / (width + 2 * MARGIN);
    if (!this.#scale) return;
    const scale = this.#scale * density;
    this.#canvas.width = Math.round(box.clientWidth * density);
    this.#canvas.height = Math.round((height + 2 * MARGIN) * scale);
    const context = this.#canvas.getContext("2d", { alpha: false });
    context.fillStyle = "#05070f";
    context.fillRect(0, 0, this.#canvas.width, this.#canvas.height);
    if (this.#realFloor) context.drawImage(this.#realFloor, 0, 0, this.#canvas.width, this.#canvas.height);
    context.setTransform(scale, 0, 0, -scale, MARGIN * scale, (height + MARGIN) * scale);
    const outer = [[0, 0, width, 0], [width, 0, width, height], [width, height, 0, height], [0, height, 0, 0]];
    const placed = (list) => this.#plan[list].filter((_, index) => plans.isPlaced(this.#plan, { list, index }));
    if (!this.#realFloor) paintGround(context, { width, height });
    paintWalls(context, { width, height, walls: [...outer, ...placed("walls")] });
    drawPlaces(context, placed("zones").filter(({ radius }) => radius > 0).map((zone) => ({ ...zone, kind: zone.kind === "hill" ? HILL : REPAIR })));
  }

  #thing(thing, isWrong) {
    const key = plans.keyOf(thing);
    const group = this.#find(key) ?? this.#made(key, thing.list);
    const one = this.#plan[thing.list][thing.index];
    group.classList.toggle("is-selected", plans.isSame(thing, this.#selected));
    group.classList.toggle("is-wrong", isWrong);
    group.setAttribute("aria-pressed", plans.isSame(thing, this.#selected));
    group.setAttribute("aria-label", isWrong ? t("floor.wrong", { name: nameOf(this.#plan, thing) }) : nameOf(this.#plan, thing));
    if (thing.list === "walls") {
      const [from, to] = [this.#point(one[0], one[1]), this.#point(one[2], one[3])];
      for (const line of group.children) set(line, { x1: from.x, y1: from.y, x2: to.x, y2: to.y });
      set(group.firstChild, { "stroke-width": this.#units(2 * REACH) });
      return group;
    }
    const { x, y } = thing.list === "zones" ? this.#point(one.x, one.y) : this.#point(one[0], one[1]);
    const radius = thing.list === "zones" ? Math.max(0, one.radius) : plans.ROBOT;
    set(group.children[0], { cx: x, cy: y, r: Math.max(radius * CM, this.#units(REACH)) });
    set(group.children[1], { cx: x, cy: y, r: radius * CM });
    if (thing.list === "starts") {
      const turn = (-plans.headingOf(this.#plan, one) * 180) / Math.PI;
      set(group.children[2], { transform: `translate(${x} ${y}) rotate(${turn})`, points: "8,-3.2 12.5,0 8,3.2" });
      set(group.children[3], { x, y: y + 2.2 });
      setText(group.children[3], String(thing.index + 1));
    }
    return group;
  }

  #made(key, list) {
    const parts = { walls: ["line", "line"], starts: ["circle", "circle", "polygon", "text"], zones: ["circle", "circle"] }[list];
    const group = svg("g", { class: `floor-thing floor-${list}`, tabindex: 0, role: "button", "data-key": key });
    group.append(...parts.map((part) => svg(part)));
    group.firstChild.setAttribute("class", "floor-hold");
    return group;
  }

  #handle(thing, { name, x, y }) {
    const key = `${plans.keyOf(thing)} ${name}`;
    const group = this.#find(key) ?? svg("g", { class: "floor-handle", tabindex: 0, role: "button", "data-key": key });
    if (!group.firstChild) group.append(svg("circle", { class: "floor-hold" }), svg("circle"));
    group.setAttribute("aria-label", t(`floor.handle_${name}`, { name: nameOf(this.#plan, thing) }));
    const place = this.#point(x, y);
    set(group.children[0], { cx: place.x, cy: place.y, r: this.#units(HOLD) });
    set(group.children[1], { cx: place.x, cy: place.y, r: this.#units(GRIP) });
    return group;
  }

  #tag({ number, x, y }) {
    const key = `tag ${number}`;
    const group = this.#find(key) ?? svg("g", { class: "floor-tag", "data-key": key, "aria-hidden": "true" });
    if (!group.firstChild) group.append(svg("rect", { width: TAG * CM, height: TAG * CM }), svg("text"));
    const place = this.#point(x, y);
    set(group.children[0], { x: place.x - (TAG * CM) / 2, y: place.y - (TAG * CM) / 2 });
    set(group.children[1], { x: place.x, y: place.y + 1.4 });
    setText(group.children[1], String(number));
    return group;
  }

  #find(key) {
    return [...this.#svg.children].find(({ dataset }) => dataset.key === key);
  }

  #point(x, y) {
    return { x: (x + MARGIN) * CM, y: (this.#plan.height + MARGIN - y) * CM };
  }

  #units(pixels) {
    return (pixels / this.#scale) * CM;
  }

  /** Where on the floor a pointer is. */
  #place({ clientX, clientY }) {
    const { left, top } = this.#svg.getBoundingClientRect();
    return { x: (clientX - left) / this.#scale - MARGIN, y: this.#plan.height + MARGIN - (clientY - top) / this.#scale };
  }

  /** The thing, and perhaps the handle, that an element stands for. */
  #held(element) {
    const [, list, index, handle = ""] = /^(walls|starts|zones)\[(\d+)\] ?(\w*)$/.exec(element.closest("[data-key]")?.dataset.key ?? "") ?? [];
    return list && { thing: { list, index: Number(index) }, handle };
  }

  #take(event) {
    const held = this.#held(event.target);
    if (!held) {
      this.#on.select(null);
      return;
    }
    this.#svg.setPointerCapture(event.pointerId);
    this.#drag = { ...held, plan: this.#plan, from: this.#place(event), key: `drag ${this.#drags++}` };
    this.#on.select(held.thing);
  }

  #pull(event) {
    if (!this.#drag) return;
    const { thing, handle, plan, from, key } = this.#drag;
    const to = this.#place(event);
    const [dx, dy] = [to.x - from.x, to.y - from.y];
    const grip = plans.handlesOf(plan, thing).find(({ name }) => name === handle); // it need not be held at its middle
    const next = grip ? plans.dragged(plan, thing, handle, { x: grip.x + dx, y: grip.y + dy }) : plans.moved(plan, thing, dx, dy);
    if (JSON.stringify(next) !== JSON.stringify(this.#plan)) this.#on.change(next, key);
  }

  #press(event) {
    const held = this.#held(event.target);
    if (!held) return;
    const { thing, handle } = held;
    const [dx, dy] = (ARROWS[event.key] ?? []).map((way) => way * STEP * (event.shiftKey ? 10 : 1));
    if (event.key === "Delete" || event.key === "Backspace") this.#on.remove(thing);
    else if (dx === undefined) return;
    else {
      const next = handle ? plans.nudged(this.#plan, thing, handle, dx, dy) : plans.moved(this.#plan, thing, dx, dy);
      this.#on.change(next, `keys ${plans.keyOf(thing)} ${handle}`);
    }
    event.preventDefault();
  }
}

function svg(tag, attributes = {}) {
  const made = document.createElementNS(SVG, tag);
  set(made, attributes);
  return made;
}

function set(node, attributes) {
  for (const [name, value] of Object.entries(attributes)) node.setAttribute(name, value);
}
