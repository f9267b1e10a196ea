// The words of the login. Pure.

import { t } from "../common/words.js";

/** The dialog for a sign-up that did not work. `reply` is the server's, or has a status word of the page's own. */
export function loginDialog(reply) {
  switch (reply.status) {
    case "UNAVAILABLE":
      return { kind: "info", title: t("login.taken"), text: t("login.taken_text", { name: reply.user }) };
    case "NO_ROBOTS":
      return { kind: "info", title: t("login.queue_full"), text: t("login.queue_full_text") };
    case "ROBOT_UNAVAILABLE":
      return { kind: "info", title: t("login.not_free", { id: reply.robot }), text: t("login.not_free_text") };
    case "NO_STORAGE":
      return { kind: "error", title: t("login.no_storage"), text: t("login.no_storage_text") };
    case "NO_ANSWER":
      return { kind: "error", title: t("login.no_answer"), text: t("login.no_answer_text") };
    case "ERROR":
      return { kind: "warning", title: t("login.not_now"), text: reply.error ?? reply.body };
    default:
      return { kind: "error", title: t("login.unknown"), text: reply.error ?? reply.body };
  }
}
