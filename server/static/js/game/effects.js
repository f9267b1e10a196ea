// What the stage shows of a shot and of the countdown.

import { SHOT } from "../battle/feedback.js";

const STEPS = "steps(10)"; // of a bar that fills during a shot: 20 pictures a second, each of which may redraw the camera's below

const calm = matchMedia("(prefers-reduced-motion: reduce)");

/** The countdown's next number drops in. */
export function count(number) {
  if (calm.matches) return;
  const frames = [
    { transform: "scale(1.7)", opacity: 0 },
    { transform: "scale(1)", opacity: 1, offset: 0.25 },
    { transform: "scale(1)", opacity: 1, offset: 0.7 },
    { transform: "scale(0.85)", opacity: 0.55 },
  ];
  number.animate(frames, { duration: 1000, easing: "ease-out" });
}

/** Whether an element is on the page now: an animation of one that is not costs as much, and nobody sees it. */
const isShown = (element) => element.getClientRects().length > 0;

/** Shows the laser's beam and its charge; a shot lasts as long as the robot's own. */
export class Laser {
  #beam;

  /** @param {Element} beam visible while the laser is on */
  constructor(beam) {
    this.#beam = beam;
  }

  /** A shot begins: the bars of the page fill until the next one. */
  fire() {
    if (isShown(this.#beam)) this.#beam.animate([{ opacity: 1 }, { opacity: 1, offset: 0.85 }, { opacity: 0 }], { duration: SHOT });
    for (const charge of [...document.querySelectorAll(".charge-fill")].filter(isShown)) {
      charge.animate([{ transform: "scaleX(0)" }, { transform: "scaleX(1)" }], { duration: SHOT, easing: STEPS });
    }
  }
}
