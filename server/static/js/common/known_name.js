// The name of a visitor whom the entrance, or another arena of its domain, knows already. The server writes the cookies.

const NAME = "laserbot_name";
const PLAY = "laserbot_play";

function value(cookies, name) {
  const found = cookies.split("; ").find((one) => one.startsWith(`${name}=`));
  return found?.slice(name.length + 1);
}

/**
 * What the cookies tell. Pure.
 * @param {string} cookies as in document.cookie
 * @returns {{name: string, avatar: number, plays: boolean}|null} `plays`: the entrance has sent the visitor to play at once
 */
export function knownName(cookies) {
  const [, avatar, name] = value(cookies, NAME)?.match(/^(\d)\.(.+)$/) ?? [];
  if (!name) return null;
  try {
    return { name: decodeURIComponent(name), avatar: Number(avatar), plays: value(cookies, PLAY) === "1" };
  } catch {
    return null;
  }
}

/** Whoever comes back to this page later is asked again. @param {string|undefined} domain of the cookies, if it is not this host's own */
export function playOnce(domain) {
  const expired = `${PLAY}=; path=/; max-age=0; samesite=lax`;
  document.cookie = expired;
  if (domain && domain !== "*") document.cookie = `${expired}; domain=${domain}`;
}
