// Who plays, as the arena's picture is told to show it (docs/protocol-browser.md, "The arena's view"). Pure.

import { PLAYING, phaseOf } from "./state.js";

/**
 * @param {import("./messages.js").Status} status
 * @param {string|null} name this page's player, null for a spectator
 * @param {(avatar: number) => string} avatarUrl absolute
 */
export function playersShown(status, name, avatarUrl) {
  return {
    me: name,
    phase: (name && phaseOf(status, name)) ?? ["idle", "countdown", "playing"][status.game],
    players: status.users.map((user) => ({
      name: user.name,
      robot: user.robot,
      avatar: avatarUrl(user.avatar),
      life: user.life,
      ready: user.ready,
      out: status.game === PLAYING && user.ready && user.life === 0,
    })),
  };
}
