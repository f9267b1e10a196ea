// What a player feels: hits, shots, the countdown.

/** ms that a shot lasts; the robot ignores further ones meanwhile. */
const SHOT = 500;

const calm = matchMedia("(prefers-reduced-motion: reduce)");

/** Life lost: the screen flashes red, the stage shakes, the phone buzzes. */
export function hit(stage, flash) {
  flash.animate([{ opacity: 1 }, { opacity: 0 }], { duration: calm.matches ? 250 : 500, easing: "ease-out" });
  navigator.vibrate?.(120);
  if (calm.matches) return;
  const shake = [0, -10, 9, -7, 5, -2, 0].map((x) => ({ transform: `translateX(${x}px)` }));
  stage.animate(shake, { duration: 380 });
}

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

/** Shows the laser's beam and its charge; a shot lasts as long as the robot's own. */
export class Laser {
  #beam;
  #charges;
  #firedAt = -Infinity;

  /**
   * @param {Element} beam visible while the laser is on
   * @param {Iterable<Element>} charges bars that fill until the next shot
   */
  constructor(beam, charges) {
    this.#beam = beam;
    this.#charges = [...charges];
  }

  /** A command with `shoot` has gone out at `now` (ms). @returns {boolean} whether it begins a shot */
  fire(now) {
    if (now - this.#firedAt < SHOT) return false;
    this.#firedAt = now;
    this.#beam.animate([{ opacity: 1 }, { opacity: 1, offset: 0.85 }, { opacity: 0 }], { duration: SHOT });
    for (const charge of this.#charges) {
      charge.animate([{ transform: "scaleX(0)" }, { transform: "scaleX(1)" }], { duration: SHOT, easing: "linear" });
    }
    return true;
  }
}
