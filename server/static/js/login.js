// The words of the login. Pure.

/** What the server takes as a name: 1 to 16 letters, digits and underscores. */
export function isValidName(name) {
  return /^[A-Za-z0-9_]{1,16}$/.test(name);
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
      return {
        kind: "warning",
        title: "No robots at this time",
        text: "Every robot has a driver. Try again when one is free.",
      };
    case "ROBOT_UNAVAILABLE":
      return { kind: "error", title: "Robot lost", text: `Robot ${reply.robot} has just become unavailable. Try again.` };
    case "NO_STORAGE":
      return {
        kind: "error",
        title: "This browser blocks storage",
        text: "The game needs local storage. Allow it for this site or use another browser.",
      };
    case "NO_ANSWER":
      return { kind: "error", title: "No answer", text: "The server does not answer. Check the network and try again." };
    default:
      return { kind: "error", title: "Unknown error", text: reply.error ?? reply.body };
  }
}
