// The game page's session with the server: who its player is, whether the server still knows them, and why not.

import * as api from "../common/api.js";
import { t } from "../common/words.js";

const RETRY = 1000; // ms between two attempts to reach the server at the start

/** The player of this browser's session, as the server knows them. Waits for the server; `onSilent()` while it does. */
export async function whoAmI(onSilent) {
  for (;;) {
    try {
      return await api.session();
    } catch {
      onSilent();
      await new Promise((resolve) => setTimeout(resolve, RETRY));
    }
  }
}

/** The session of one player, until it ends. */
export class Session {
  /** The server did not answer: it may have forgotten its players. */
  serverWasLost = false;
  #me;
  #ask;
  #onEnd;
  #onOther;
  #checking = null; // the question that is under way
  #isOver = false;

  /**
   * @param {object} use
   * @param {{name: string, robot: number}} use.me
   * @param {(message: object, ms: number) => void} use.onEnd the server knows this player no more: what to say, how long
   * @param {() => void} use.onOther another tab of this browser has signed in again
   * @param {() => Promise<object>} [use.ask]
   */
  constructor({ me, onEnd, onOther, ask = api.session }) {
    this.#me = me;
    this.#onEnd = onEnd;
    this.#onOther = onOther;
    this.#ask = ask;
  }

  /** Ask the server whether the player is still signed in: the session, or null. Several questions at once are one. */
  check() {
    this.#checking ??= this.#answer().finally(() => (this.#checking = null));
    return this.#checking;
  }

  /** Nothing is told any more. */
  end() {
    this.#isOver = true;
  }

  async #answer() {
    const session = await this.#ask().catch(() => null); // no answer: the heartbeat goes on asking
    if (!session || this.#isOver) return null;
    if (session.status === "UNREGISTERED") {
      const why = this.serverWasLost ? "restarted" : "robot_lost";
      this.#onEnd({ kind: "error", title: t(`home.${why}`), text: t(`home.${why}_text`) }, 2500);
    } else if (session.status === "QUEUED") {
      this.#onEnd({ kind: "info", title: t("home.turn_over"), text: t("home.turn_over_text") }, 4000);
    } else if (session.user !== this.#me.name || session.robot !== this.#me.robot) {
      this.#onOther();
    } else {
      this.serverWasLost = false;
      return session;
    }
    return null;
  }
}

/**
 * What the server's reply to a sign-out means. Pure.
 * @returns {{isOut: boolean, message: object}}
 */
export function signedOut(reply, name) {
  if (reply?.status === "OK") {
    return { isOut: true, message: { kind: "success", title: t("home.signed_out"), text: t("home.signed_out_text") } };
  }
  if (reply?.status === "UNREGISTERED") {
    return { isOut: true, message: { kind: "error", title: t("home.not_logged_in"), text: t("home.unknown", { name }) } };
  }
  const text = reply ? (reply.error ?? reply.body) : t("home.does_not_answer");
  return { isOut: false, message: { kind: "error", title: t("home.still_signed_in"), text } };
}
