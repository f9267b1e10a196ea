// Where the page's pictures are: their names carry a hash of their content.

/** The address of a picture of server/static, such as "img/logo.svg"; build.mjs puts their names in. */
export const asset = (name) => `/static/${PICTURES[name]}`;

/** The address of a player's picture. */
export const avatarUrl = (index) => asset(`img/avatar${index}.svg`);
