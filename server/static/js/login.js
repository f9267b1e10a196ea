// The words of the login. Pure.

/** What the server takes as a name: 1 to 16 letters, digits (of any script) and underscores. */
export function isValidName(name) {
  return /^[\p{L}\p{N}_][\p{L}\p{N}\p{M}_]{0,15}$/u.test(name) && !/\p{Default_Ignorable_Code_Point}/u.test(name);
}

/** The dialog for a sign-up that did not work. `reply` is the server's, or has a status word of the page's own. */
export function loginDialog(reply) {
  switch (reply.status) {
    case "BAD_NAME":
      return {
        kind: "warning",
        title: "This name does not work",
        text: "Use 1 to 16 letters, digits or underscores; no spaces or special characters.",
      };
    case "UNAVAILABLE":
      return { kind: "info", title: "Name taken", text: `“${reply.user}” is playing already. Please choose another name.` };
    case "NO_ROBOTS":
      return { kind: "info", title: "The queue is full", text: "Too many people wait for a robot. Try again in some minutes." };
    case "ROBOT_UNAVAILABLE":
      return {
        kind: "info",
        title: `Robot ${reply.robot} is not free`,
        text: "Somebody was faster, or others wait for a robot. Choose another one, or any robot.",
      };
    case "NO_STORAGE":
      return {
        kind: "error",
        title: "This browser blocks storage",
        text: "The game needs local storage. Allow it for this site or use another browser.",
      };
    case "NO_ANSWER":
      return { kind: "error", title: "No answer", text: "The server does not answer. Check the network and try again." };
    case "ERROR":
      return { kind: "warning", title: "That does not work", text: reply.error ?? reply.body };
    default:
      return { kind: "error", title: "Unknown error", text: reply.error ?? reply.body };
  }
}
