// Who plays, as the picture of the arena shows it. Pure.

import { avatarUrl } from "../common/assets.js";
import { DOUBLE_DAMAGE, SHIELD } from "./effects.js";
import { PLAYING } from "./state.js";
import { arenaColour } from "./teams.js";

const PHASES = ["stopped", "countdown", "playing"];

/**
 * @param {import("./messages.js").Status} status
 * @param {string|null} me this page's player; null for a spectator
 */
export function arenaPlayers(status, me) {
  const players = status.users.map(({ name, robot, life, ready, avatar, team, effects }) => ({
    name, robot, life, ready, out: status.game === PLAYING && ready && life === 0, avatar: avatarUrl(avatar), colour: arenaColour(team) ?? null,
    shield: Boolean(effects & SHIELD), doubleDamage: Boolean(effects & DOUBLE_DAMAGE),
  }));
  return { me, players, phase: PHASES[status.game] };
}
