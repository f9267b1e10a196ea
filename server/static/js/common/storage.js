// What the browser remembers of its player: the key `user` of localStorage. The server alone knows who is signed in.

const KEY = "user";
export const AVATARS = 5;

/** Whether the browser keeps anything (it may refuse in a private window). */
export function isAvailable() {
  try {
    localStorage.setItem("laserbot-test", "");
    localStorage.removeItem("laserbot-test");
    return true;
  } catch {
    return false;
  }
}

/** @returns {{name: string, life: number, robotN: number, imgIndex: number, date: string, ready: number}|null} */
export function load() {
  try {
    const user = JSON.parse(localStorage.getItem(KEY));
    return typeof user?.name === "string" ? user : null;
  } catch {
    return null;
  }
}

/** Remember a player who has just signed in. */
export function save(name, robotN, imgIndex, now) {
  const date = now.toString().split("GMT")[0].trim();
  const user = { name, life: 100, robotN, imgIndex, date, ready: 0 };
  localStorage.setItem(KEY, JSON.stringify(user));
  return user;
}

export function forget() {
  localStorage.removeItem(KEY);
}
