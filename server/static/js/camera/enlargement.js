// How a small picture fills a large page where the computer's processor draws. Pure.
//
// The browser would enlarge the picture smoothly with each picture of the screen, also when only a small thing over it has
// changed: the most that such a page costs. Half of it is done once for each picture, smoothly; the rest, without smoothing,
// is quick, and of so little that it is hardly seen.

/**
 * How many times as wide as the picture its canvas is to be.
 * @param {number} width of the picture, in pixels
 * @param {number} shown how wide it is on the screen, in pixels
 */
export const enlargement = (width, shown) => Math.max(1, Math.floor(shown / width / 2));
