// The login page.

import * as api from "./api.js";
import * as dialogs from "./dialogs.js";
import { avatarUrl, setText } from "./dom.js";
import { isValidName, loginDialog } from "./login.js";
import * as storage from "./storage.js";

const POLL = 1000; // ms between two questions for free robots

const form = document.getElementById("login");
const nameField = document.getElementById("username");
const picture = document.getElementById("userImage");
const robots = document.getElementById("availableR");
const connectionState = document.getElementById("connection-state");

let avatar = Math.floor(Math.random() * storage.AVATARS);
let busy = false;

function showAvatar() {
  picture.src = avatarUrl(avatar);
  picture.alt = `Robot picture ${avatar + 1} of ${storage.AVATARS}`;
}

/** Sign up and go to the battle. The reply, also where the page itself says no. */
async function logIn() {
  const name = nameField.value.trim();
  if (!isValidName(name)) return { status: "BAD_NAME" };
  if (!storage.isAvailable()) return { status: "NO_STORAGE" };
  const reply = await api.signUp(name, avatar).catch(() => ({ status: "NO_ANSWER" }));
  if (reply.status === "OK") {
    storage.save(reply.user, reply.robot, avatar, new Date());
    location.assign("/home");
  }
  return reply;
}

/** Ask about a player who is still signed in from this browser. What the server does not know any more is forgotten. */
async function offerRestore() {
  const session = await api.session().catch(() => null);
  if (!session || busy) return;
  if (session.status !== "OK") {
    storage.forget();
    return;
  }
  const restore = await dialogs.show({
    title: `You are logged in as “${session.user}”.`,
    text: `Robot ${session.robot} is still yours. Do you want to go on with this session?`,
    ok: "OK",
    cancel: "Cancel",
  });
  if (restore) {
    location.assign("/home");
    return;
  }
  await api.signOut(session.user).catch(() => null);
  storage.forget();
  nameField.focus();
}

async function showRobots() {
  try {
    const reply = await api.availableRobots();
    setText(robots, String(reply.availableR));
    robots.dataset.none = reply.availableR === 0;
    connectionState.hidden = true;
  } catch {
    setText(robots, "?");
    connectionState.hidden = false;
  }
  setTimeout(showRobots, POLL);
}

form.addEventListener("submit", async (event) => {
  event.preventDefault();
  if (busy) return;
  busy = true;
  const reply = await logIn();
  if (reply.status === "OK") return; // busy until the next page is there
  busy = false; // before the dialog: its end is told late, and Enter must count as soon as it is gone
  dialogs.show(loginDialog(reply));
});
document.getElementById("avatar").addEventListener("click", () => {
  avatar = (avatar + 1) % storage.AVATARS;
  showAvatar();
});
document.getElementById("how-to").addEventListener("click", dialogs.help);
addEventListener("pageshow", (event) => event.persisted && location.reload()); // back from home: all may have changed

showAvatar();
showRobots();
offerRestore();
