// Where the page's pictures are: their names carry a hash of their content.

/* global PICTURES */ // {"img/logo.svg": "logo-12AB34CD.svg"}, put in by build.mjs

/** The address of a picture of server/static, such as "img/logo.svg". */
export const asset = (name) => `/static/${PICTURES[name]}`;

/** The address of a player's picture. */
export const avatarUrl = (index) => asset(`img/avatar${index}.svg`);
