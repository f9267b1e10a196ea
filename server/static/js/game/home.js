// The game page: what is the state of the battle, where do my commands go.

import { socketAddress } from "../common/addresses.js";
import * as api from "../common/api.js";
import { Connection } from "../drive/connection.js";
import * as dialogs from "../common/dialogs.js";
import { Driver } from "../drive/driver.js";
import { Laser, count } from "./effects.js";
import { OwnCamera } from "./own_camera.js";
import { Feedback } from "../battle/feedback.js";
import { FeedList } from "../battle/feed_words.js";
import { connectGame } from "./controls.js";
import { openArena } from "./arena.js";
import { connectSwitches, settingsForm } from "./settings.js";
import { Guide } from "./guide.js";
import { Heartbeat } from "./heartbeat.js";
import { help } from "../common/help.js";
import { HitMarks } from "./hit_marks.js";
import { makeJolt, vibrate } from "../common/jolt.js";
import { LinkQuality } from "./link.js";
import { fromReply, fromTopic } from "../battle/messages.js";
import { connectPreferences } from "../common/preferences.js";
import { Preferences } from "../common/preferences_store.js";
import { showResult } from "./result.js";
import { Session, signedOut, whoAmI } from "./session.js";
import { Speaker } from "../common/speaker.js";
import * as state from "../battle/state.js";
import * as storage from "../common/storage.js";
import { OwnTournament } from "../battle/own_tournament.js";
import { TeamChoice } from "../battle/team_view.js";
import * as view from "./view.js";
import { t } from "../common/words.js";

const TICK = 500; // ms between two looks at whether a heartbeat is due
const CORNER = 0.5; // scale of the arena in the corner, as in css/own_camera.css
const REFUSED = 3000; // ms that a refusal is shown; rosbridge repeats it every second while commands come

const byId = (id) => document.getElementById(id);

/** One signed-in player on this page, from login to leaving. */
class Game {
  #me; // { name, robot, avatar, date }
  #status = null;
  #connection;
  #heartbeat;
  #driver;
  #arena;
  #realFloor;
  #ownCamera;
  #guide;
  #feed = new FeedList(byId("feed"));
  #quality = new LinkQuality();
  #pulse = new Worker(document.querySelector("meta[name=pulse]").content);
  #timer = null;
  #left = false;
  #asking = false; // a change of ready is under way
  #session;
  #refusal = "";
  #refusalTimer = null;
  #signingOut = false;
  #preferences = new Preferences();
  #speaker = new Speaker(this.#preferences);
  #feedback = new Feedback({ speaker: this.#speaker, vibrate, jolt: makeJolt(byId("stage"), byId("flash")) });
  #laser = new Laser(byId("beam"));
  #marks = new HitMarks(byId("hit-mark"), byId("hit-note"));
  #tournament;
  #teams = new TeamChoice(byId("teams"), (team) => this.#chooseTeam(team));

  constructor(me) {
    this.#me = me;
    const { arena, realFloor } = openArena({
      preferences: this.#preferences,
      getTicket: () => this.#session.check(),
      onState: (state) => this.#ownCamera.takeArena(state !== "none"),
    });
    this.#arena = arena;
    this.#realFloor = realFloor;
    this.#tournament = new OwnTournament(me.name, byId("tournament"));
    this.#session = new Session({
      me,
      onEnd: (message, ms) => this.#leave(message, ms),
      onOther: () => location.reload(),
    });
    this.#connection = new Connection({
      url: socketAddress("rosbridge"),
      onStatus: (message) => {
        this.#heartbeat.tick(false);
        this.#take(fromTopic(message));
      },
      onChange: () => {
        this.#quality.clear();
        this.#showConnection();
      },
      onRefusal: (reason) => this.#refuse(reason),
      onRoundTrip: (ms) => {
        this.#quality.add(ms);
        this.#showConnection();
      },
      getTicket: () => this.#session.check(),
      topics: [...arena.topics, ...realFloor.topics],
    });
    this.#heartbeat = new Heartbeat({
      post: () => {
        this.#pulse.postMessage("the page is not too busy");
        return api.gameStatus();
      },
      now: () => performance.now(),
      onReply: (reply) => this.#connection.up || this.#take(fromReply(reply, this.#status)),
      onLost: () => {
        this.#session.serverWasLost = true;
        this.#showConnection();
      },
      onBack: () => {
        this.#showConnection();
        this.#session.check(); // the server may have forgotten its players
      },
    });
    this.#ownCamera = new OwnCamera({
      robot: me.robot,
      preferences: this.#preferences,
      getTicket: () => this.#session.check(),
      onView: (view) => {
        this.#arena.scale = view === "camera" ? CORNER : 1;
        this.#guide.show();
      },
      onPicture: () => this.#arena.join(),
    });
    this.#guide = new Guide({
      box: byId("guide"),
      preferences: this.#preferences,
      robot: me.robot,
      getView: () => (byId("stage").dataset.view === "arena" && byId("arena").hidden ? "none" : byId("stage").dataset.view),
    });
    this.#driver = new Driver({
      send: (command) => {
        const sent = this.#connection.publish(me.robot, command);
        if (!sent || !command.shoot || this.#refusal || !state.mayShoot(this.#status, me.name)) return;
        if (!this.#feedback.fire(performance.now())) return;
        this.#laser.fire();
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
    connectGame({
      driver: this.#driver,
      preferences: this.#preferences,
      speaker: this.#speaker,
      thumbs: byId("thumbs"),
      padHint: byId("pad-hint"),
      onChange: () => {
        view.showHeld(this.#driver.actions);
        if (!this.#refusal) this.#guide.act(this.#driver.actions);
      },
      onReady: () => this.#toggleReady(),
      onPads: (count) => this.#guide.countPads(count),
    });
    connectSwitches({ sound: byId("sound"), fullscreen: byId("fullscreen") }, this.#preferences);
    byId("ready-btn").addEventListener("click", () => this.#toggleReady());
    byId("settings").addEventListener("click", () => this.#pause(() => this.#showSettings()));
    byId("sign-out").addEventListener("click", () => this.#askSignOut());
    byId("how-to").addEventListener("click", () => this.#pause(help));
    this.#connection.start();
    this.#ownCamera.start();
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
      this.#session.check();
      return;
    }
    this.#status = status;
    if (state.mayDrive(status, name) && !this.#signingOut) this.#driver.start();
    else this.#stopDriving();
    if (me.avatar !== this.#me.avatar && this.#connection.up) this.#me.avatar = me.avatar;
    view.showPlayer(this.#me);
    view.showStatus(status, name, this.#refusal);
    this.#tournament.take(status);
    this.#teams.show(state.teamChoice(status, name));
    if (view.showCountdown(status)) count(byId("countdown"));
    view.announce(state.announcement(previous, status, name));
    this.#feed.take(previous, status);
    this.#arena.take(status, name);
    this.#feedback.take(previous, status, name);
    this.#marks.take(previous, status, name);
    this.#guide.take(previous, status, name, this.#driver.driving);
    if (state.hasEnded(previous, status, name)) this.#showResult(status);
    else if (status.game !== state.STOPPED && previous?.game === state.STOPPED) dialogs.closeAll(); // the next one begins
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

  async #showResult(status) {
    const answer = await showResult(status, this.#me.name);
    if (answer === "ok") this.#setReady(true);
    else if (answer === "give") this.#signOut("/watch");
  }

  #showConnection() {
    view.showConnection(state.connectionState(this.#connection.up, !this.#heartbeat.lost), this.#quality.value);
  }

  #toggleReady() {
    const me = this.#status && state.findUser(this.#status, this.#me.name);
    if (me && !state.readyButton(this.#status, me.name).hidden) this.#setReady(!me.ready);
  }

  #showSettings() {
    return dialogs.show({ kind: null, title: t("home.settings"), body: [settingsForm(this.#preferences, this.#speaker)] });
  }

  async #setReady(ready) {
    if (this.#asking) return;
    this.#asking = true;
    const reply = await api.setReady(this.#me.name, ready).catch(() => null);
    this.#asking = false;
    if (!reply) {
      dialogs.toast(t("home.no_answer"));
    } else if (reply.status === "STARTED") {
      dialogs.show({ title: t("home.running"), text: t("home.running_text") });
    } else if (reply.status === "ROBOT_UNAVAILABLE") {
      dialogs.toast(t("home.robot_away"));
    } else if (reply.status !== "OK") {
      console.error("playerReady:", reply.body);
      this.#session.check();
    }
  }

  async #chooseTeam(team) {
    const reply = await api.chooseTeam(this.#me.name, team).catch(() => null);
    if (!reply) dialogs.toast(t("home.no_answer"));
    else if (reply.status === "STARTED") dialogs.show({ title: t("home.running"), text: t("home.running_text") });
    else if (reply.status !== "OK") console.error("chooseTeam:", reply.body);
  }

  async #askSignOut() {
    const sure = await this.#pause(() =>
      dialogs.show({
        kind: "warning",
        title: t("home.sure"),
        text: t("home.sure_text"),
        ok: t("home.sign_out"),
        cancel: t("common.cancel"),
      }),
    );
    if (sure) this.#signOut("/");
    else dialogs.toast(t("home.still"));
  }

  /** Give the robot back and go to another page. */
  async #signOut(page) {
    this.#signingOut = true; // the next news of the battle must not hand the controls back
    this.#stopDriving();
    const reply = await api.signOut(this.#me.name).catch(() => null);
    this.#signingOut = false;
    const { isOut, message } = signedOut(reply, this.#me.name);
    if (isOut) this.#leave(message, 1500, page);
    else dialogs.show(message);
  }

  /** The end of this page: say why, then to another one after `ms`. */
  #leave(message, ms, page = "/") {
    this.#left = true;
    this.#session.end();
    clearInterval(this.#timer);
    this.#stopDriving();
    this.#feedback.stop();
    this.#pulse.terminate();
    this.#connection.stop();
    this.#ownCamera.stop();
    this.#realFloor.stop();
    storage.forget();
    dialogs.show({ ...message, ok: null });
    setTimeout(() => location.replace(page), ms);
  }
}

async function main() {
  const session = await whoAmI(() => view.showConnection(state.connectionState(false, false), null));
  if (session.status === "QUEUED") {
    location.replace("/");
    return;
  }
  if (session.status !== "OK") {
    storage.forget();
    dialogs.show({ kind: "warning", title: t("home.not_logged_in"), text: t("home.back"), ok: null });
    setTimeout(() => location.replace("/"), 2000);
    return;
  }
  let user = storage.load();
  if (user?.name !== session.user || user.robotN !== session.robot) {
    user = storage.save(session.user, session.robot, 0, new Date());
  }
  new Game({ name: session.user, robot: session.robot, avatar: user.imgIndex, date: user.date }).start();
}

connectPreferences();
addEventListener("pageshow", (event) => event.persisted && location.reload()); // the sockets of a restored page are dead
main();
