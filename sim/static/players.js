// Who plays, as the game's page around the arena tells it: strangers' data until it has been looked at.

const MOST = 64; // players
const NAME = 32; // characters
const ADDRESS = 512;
const LABELS = { you: 16, hit: 16, empty: 64 };
const EFFECTS = ["full", "reduced", "auto"];
const LEAST_SCALE = 0.1;
const MAX_ROBOT = 127; // the ROS service's int8

/** @typedef {{name: string, robot: number, avatar: string|null, life: number, out: boolean, ready: boolean,
 *   colour: string|null}} Player */
/** @typedef {{me: string|null, phase: string, effects: string, scale: number, labels: object, players: Player[]}} Players */

/** Whether a page of this origin belongs to the game: the same host name as the arena's, on any port. */
export function isGame(origin, hostname) {
  const url = parse(origin);
  return url !== null && ["http:", "https:"].includes(url.protocol) && url.hostname === hostname;
}

/**
 * What a page of `origin` says about the players; null if it says something else. A field that is not what it should be
 * is left out, a player without name or robot too.
 * @returns {Players|null}
 */
export function readPlayers(data, origin) {
  if (data?.type !== "laserbot-players" || !Array.isArray(data.players)) return null;
  const players = new Map();
  for (const entry of data.players.slice(0, MOST)) {
    const player = readPlayer(entry, origin);
    if (player && !players.has(player.robot)) players.set(player.robot, player);
  }
  return {
    me: isText(data.me, NAME) ? data.me : null,
    phase: typeof data.phase === "string" && /^[a-z]{1,16}$/.test(data.phase) ? data.phase : "",
    effects: EFFECTS.includes(data.effects) ? data.effects : "auto",
    scale: Number.isFinite(data.scale) ? Math.min(1, Math.max(LEAST_SCALE, data.scale)) : 1,
    labels: readLabels(data.labels),
    players: [...players.values()],
  };
}

function readPlayer(entry, origin) {
  const { name, robot, avatar, life, out, ready, colour } = entry ?? {};
  if (!isText(name, NAME) || !Number.isInteger(robot) || robot < 0 || robot > MAX_ROBOT) return null;
  return {
    name,
    robot,
    avatar: readAvatar(avatar, origin),
    life: Number.isFinite(life) ? Math.min(100, Math.max(0, Math.round(life))) : 100,
    out: out === true,
    ready: ready === true,
    colour: typeof colour === "string" && /^#[0-9a-f]{6}$/i.test(colour) ? colour : null,
  };
}

/** A picture comes from the page that names it, or not at all: the arena asks no other site for anything. */
function readAvatar(avatar, origin) {
  if (!isText(avatar, ADDRESS)) return null;
  const url = parse(avatar, origin);
  return url && url.origin === origin && !url.username && !url.password ? url.href : null;
}

function readLabels(labels) {
  const known = Object.entries(LABELS).filter(([key, most]) => isText(labels?.[key], most));
  return Object.fromEntries(known.map(([key]) => [key, labels[key]]));
}

const isText = (value, most) => typeof value === "string" && value.length > 0 && value.length <= most;

function parse(address, base) {
  try {
    return new URL(address, base);
  } catch {
    return null;
  }
}
