// The game page: who am I, what is the state of the battle, where do my commands go.

import * as api from "./api.js";
import { connectControls } from "./controls.js";
import * as dialogs from "./dialogs.js";
import { Driver } from "./driver.js";
import * as effects from "./effects.js";
import { Heartbeat } from "./heartbeat.js";
import { Connection } from "./connection.js";
import { fromReply, fromTopic } from "./messages.js";
import * as state from "./state.js";
import * as storage from "./storage.js";
import * as view from "./view.js";

const TICK = 500; // ms between two looks at whether a heartbeat is due
const RETRY = 1000; // ms between two attempts to reach the server at the start
const REFUSED = 3000; // ms that a refusal is shown; rosbridge repeats it every second while commands come

const byId = (id) => document.getElementById(id);

/** One signed-in player on this page, from login to leaving. */
class Game {
  #me; // { name, robot, avatar, date }
  #status = null;
  #connection;
  #heartbeat;
  #driver;
  #timer = null;
  #left = false;
  #asking = false; // a change of ready is under way
  #checking = null; // the question for the session that is under way
  #refusal = "";
  #refusalTimer = null;
  #signingOut = false;
  #laser = new effects.Laser(byId("beam"), document.querySelectorAll(".charge-fill"));

  constructor(me) {
    this.#me = me;
    const port = document.querySelector("meta[name=rosbridge-port]").content;
    const scheme = location.protocol === "https:" ? "wss" : "ws";
    this.#connection = new Connection({
      url: `${scheme}://${location.hostname}:${port}`,
      onStatus: (message) => {
        this.#heartbeat.tick(false);
        this.#take(fromTopic(message));
      },
      onChange: () => this.#showConnection(),
      onRefusal: (reason) => this.#refuse(reason),
      getTicket: () => this.#checkSession(),
    });
    this.#heartbeat = new Heartbeat({
      post: api.gameStatus,
      now: () => performance.now(),
      onReply: (reply) => this.#connection.up || this.#take(fromReply(reply, this.#status)),
      onLost: () => this.#showConnection(),
      onBack: () => {
        this.#showConnection();
        this.#checkSession(); // the server may have forgotten its players
      },
    });
    this.#driver = new Driver({
      send: (command) => {
        const sent = this.#connection.publish(me.robot, command);
        if (sent && command.shoot && !this.#refusal) this.#laser.fire(performance.now());
      },
      every: (ms, act) => {
        const timer = setInterval(act, ms);
        return () => clearInterval(timer);
      },
    });
  }

  start() {
    view.showPlayer(this.#me);
    this.#showConnection();
    connectControls(this.#driver, () => view.showHeld(this.#driver.actions));
    byId("ready-btn").addEventListener("click", () => this.#toggleReady());
    byId("sign-out").addEventListener("click", () => this.#askSignOut());
    for (const button of document.querySelectorAll("#how-to, #how-to-menu")) {
      button.addEventListener("click", () => this.#pause(dialogs.help));
    }
    this.#connection.start();
    const beat = () => this.#heartbeat.tick(!this.#connection.up);
    this.#timer = setInterval(beat, TICK);
    beat();
  }

  /** A new state of the battle has arrived. */
  #take(status) {
    if (this.#left) return;
    const { name } = this.#me;
    const previous = this.#status;
    const me = state.findUser(status, name);
    if (!me) {
      this.#checkSession();
      return;
    }
    this.#status = status;
    if (state.mayDrive(status, name) && !this.#signingOut) this.#driver.start();
    else this.#stopDriving();
    if (me.avatar !== this.#me.avatar && this.#connection.up) this.#me.avatar = me.avatar;
    view.showPlayer(this.#me);
    view.showStatus(status, name, this.#refusal);
    view.announce(state.announcement(previous, status, name));
    if (state.lifeLost(previous, status, name) > 0) effects.hit(byId("stage"), byId("flash"));
    if (state.hasEnded(previous, status, name)) this.#showResult(state.ranking(status.result, name));
  }

  #stopDriving() {
    if (!this.#driver.driving) return;
    this.#driver.stop();
    this.#connection.unadvertise();
    view.showHeld(this.#driver.actions);
    this.#setRefusal("");
  }

  /** rosbridge refuses this page's commands. That the last stop of a battle comes too late is no news. */
  #refuse(reason) {
    if (!this.#driver.driving) return;
    this.#setRefusal(state.refusalText(reason));
    this.#connection.signIn();
  }

  #setRefusal(text) {
    clearTimeout(this.#refusalTimer);
    if (text) this.#refusalTimer = setTimeout(() => this.#setRefusal(""), REFUSED);
    if (text === this.#refusal) return;
    this.#refusal = text;
    view.showStatus(this.#status, this.#me.name, text);
    view.announce(text);
  }

  /** Let go of the controls, then show a dialog. */
  #pause(showDialog) {
    this.#driver.releaseAll();
    view.showHeld(this.#driver.actions);
    return showDialog();
  }

  #showResult({ title, text, won, rows }) {
    dialogs.show({ kind: won ? "trophy" : "broken", title, text, body: [view.rankingList(rows)], calm: true });
  }

  #showConnection() {
    view.showConnection(state.connectionState(this.#connection.up, !this.#heartbeat.lost));
  }

  async #toggleReady() {
    if (!this.#status || this.#asking) return;
    this.#asking = true;
    const { ready } = state.readyButton(this.#status, this.#me.name);
    const reply = await api.setReady(this.#me.name, !ready).catch(() => null);
    this.#asking = false;
    if (!reply) {
      dialogs.toast("The server does not answer: try again.");
    } else if (reply.status === "STARTED") {
      dialogs.show({ title: "A battle is running", text: "Wait until it is over, then press ready." });
    } else if (reply.status === "ROBOT_UNAVAILABLE") {
      dialogs.toast("Your robot does not answer. It has some seconds to come back.");
    } else if (reply.status !== "OK") {
      console.error("playerReady:", reply.body);
      this.#checkSession();
    }
  }

  async #askSignOut() {
    const sure = await this.#pause(() =>
      dialogs.show({
        kind: "warning",
        title: "Sign out?",
        text: "Your robot becomes free for others. If a battle is running, you lose your place in it.",
        ok: "Sign out",
        cancel: "Cancel",
      }),
    );
    if (!sure) {
      dialogs.toast("You are still signed in.");
      return;
    }
    this.#signingOut = true; // the next news of the battle must not hand the controls back
    this.#stopDriving();
    const reply = await api.signOut(this.#me.name).catch(() => null);
    this.#signingOut = false;
    if (reply?.status === "OK") {
      this.#leave({ kind: "success", title: "Signed out", text: "See you in the arena." }, 1500);
    } else if (reply?.status === "UNREGISTERED") {
      this.#leave({ kind: "error", title: "Not logged in", text: `The server does not know “${this.#me.name}”.` }, 1500);
    } else {
      const text = reply ? (reply.error ?? reply.body) : "The server does not answer.";
      dialogs.show({ kind: "error", title: "Still signed in", text });
    }
  }

  /** Ask the server whether this page's player is still signed in: the session, or null. If not, say so once and go. */
  #checkSession() {
    this.#checking ??= this.#askForSession().finally(() => (this.#checking = null));
    return this.#checking;
  }

  async #askForSession() {
    const session = await api.session().catch(() => null); // no answer: the heartbeat goes on asking
    if (!session || this.#left) return null;
    if (session.status === "UNREGISTERED") {
      const text = "The connection to your robot is lost, so you have been signed out.";
      this.#leave({ kind: "error", title: "Robot lost", text }, 2500);
    } else if (session.status === "QUEUED") {
      const text = "Your robot has passed on, or it is out of service. You have a place in the queue.";
      this.#leave({ kind: "info", title: "Your turn is over", text }, 4000);
    } else if (session.user !== this.#me.name || session.robot !== this.#me.robot) {
      location.reload(); // another tab of this browser has signed in again
    } else {
      return session;
    }
    return null;
  }

  /** The end of this page: say why, then back to the login after `ms`. */
  #leave(message, ms) {
    this.#left = true;
    clearInterval(this.#timer);
    this.#stopDriving();
    this.#connection.stop();
    storage.forget();
    dialogs.show({ ...message, ok: null });
    setTimeout(() => location.replace("/"), ms);
  }
}

/** The player of this browser's session, as the server knows him. Waits for the server. */
async function whoAmI() {
  for (;;) {
    try {
      return await api.session();
    } catch {
      view.showConnection(state.connectionState(false, false));
      await new Promise((resolve) => setTimeout(resolve, RETRY));
    }
  }
}

/** The arena's view on the stage, where there is one: it is on the host that served this page. */
function showArena() {
  const port = document.querySelector("meta[name=view-port]")?.content;
  if (!port) return;
  const camera = byId("camera");
  camera.src = `${location.protocol}//${location.hostname}:${port}/?embedded`;
  camera.hidden = false;
  document.body.classList.add("has-camera");
}

async function main() {
  const session = await whoAmI();
  if (session.status === "QUEUED") {
    location.replace("/");
    return;
  }
  if (session.status !== "OK") {
    storage.forget();
    dialogs.show({ kind: "warning", title: "You are not logged in", text: "Back to the login.", ok: null });
    setTimeout(() => location.replace("/"), 2000);
    return;
  }
  let user = storage.load();
  if (user?.name !== session.user || user.robotN !== session.robot) {
    user = storage.save(session.user, session.robot, 0, new Date());
  }
  showArena();
  new Game({ name: session.user, robot: session.robot, avatar: user.imgIndex, date: user.date }).start();
}

byId("sidebar-toggle").addEventListener("click", (event) => {
  const hidden = document.body.classList.toggle("no-sidebar");
  event.currentTarget.setAttribute("aria-expanded", !hidden);
});
addEventListener("pageshow", (event) => event.persisted && location.reload()); // the sockets of a restored page are dead
main();
