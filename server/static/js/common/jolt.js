// What a hit does to the page and to the phone: flash, shake, vibration.

const KINDS = {
  hit: { flash: 500, shake: 380, far: 10 }, // ms, ms, px
  out: { flash: 1200, shake: 700, far: 18 },
};
const CALM_FLASH = 0.35; // of the full flash
const PAUSE = 350; // ms from one flash to the next: more than three a second are a danger to some

/** Make the phone buzz, where it can. @param {number[]} pattern ms on, off, on... */
export const vibrate = (pattern) => navigator.vibrate?.(pattern);

/** How the stage swings out, from `far` px to rest. */
export function shakeFrames(far) {
  return [0, -1, 0.9, -0.7, 0.5, -0.2, 0].map((part) => ({ transform: `translateX(${part * far}px)` }));
}

/**
 * What jolts the page; a visitor who wants little motion sees a faint flash and no shaking.
 * @param {Element} stage is shaken
 * @param {Element} flash covers the page; invisible by its style
 * @returns {(kind: "hit"|"out") => void}
 */
export function makeJolt(stage, flash) {
  const calm = matchMedia("(prefers-reduced-motion: reduce)");
  let flashedAt = -Infinity;
  return (kind) => {
    const { flash: duration, shake, far } = KINDS[kind];
    const now = performance.now();
    if (now - flashedAt >= PAUSE) {
      flashedAt = now;
      flash.animate([{ opacity: calm.matches ? CALM_FLASH : 1 }, { opacity: 0 }], { duration, easing: "ease-out" });
    }
    if (!calm.matches) stage.animate(shakeFrames(far), { duration: shake });
  };
}
