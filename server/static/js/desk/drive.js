// The test drive of a robot that is out of service: the player's pad and keys, signed in to rosbridge as the operator.

import { socketAddress } from "../common/addresses.js";
import * as api from "./api.js";
import { t } from "../common/words.js";
import { Connection } from "../drive/connection.js";
import { connectKeyboard } from "../drive/controls.js";
import { Driver } from "../drive/driver.js";
import { setText } from "../common/dom.js";
import { connectFire, connectPad } from "../drive/touch.js";

const INTERVAL = 50; // ms between two commands: 20 Hz
const REFUSED = 3000; // ms that a refusal is shown; rosbridge repeats it every second while commands come

const byId = (id) => document.getElementById(id);

/** One at a time, in the panel #drive. */
export class TestDrive {
  #driver;
  #connection = null;
  #robot = null;
  #opener = null; // has the focus again afterwards
  #refusalTimer = null;

  constructor() {
    this.#driver = new Driver({
      send: (command) => this.#connection?.publish(this.#robot, command),
      every: (ms, act) => {
        const timer = setInterval(act, ms);
        return () => clearInterval(timer);
      },
      interval: INTERVAL,
    });
    const pad = byId("pad");
    const showHeld = () => {
      for (const node of document.querySelectorAll("#drive [data-action]")) {
        node.classList.toggle("is-held", this.#driver.actions.has(node.dataset.action));
      }
    };
    const letGo = () => {
      this.#driver.releaseAll();
      showHeld();
    };
    connectKeyboard(pad, this.#driver, showHeld);
    connectPad(pad, this.#driver, showHeld);
    connectFire(byId("fire"), this.#driver, showHeld);
    pad.addEventListener("pointerdown", () => pad.focus()); // its default, which would, is prevented
    pad.addEventListener("blur", letGo);
    addEventListener("blur", letGo);
    addEventListener("pagehide", letGo);
    document.addEventListener("visibilitychange", () => document.hidden && letGo());
    byId("drive").addEventListener("keydown", (event) => event.key === "Escape" && this.stop());
    byId("drive-stop").addEventListener("click", () => this.stop());
  }

  /** The robot that is driven, or null. */
  get robot() {
    return this.#robot;
  }

  /** Rejects when the server gives no ticket. */
  async start(robot) {
    const opener = document.activeElement;
    await api.drive();
    this.stop(); // the drive of another robot
    this.#opener = opener;
    this.#robot = robot;
    this.#connection = new Connection({
      url: socketAddress("rosbridge"),
      onStatus: () => {},
      onChange: () => this.#showConnection(),
      onRefusal: (reason) => this.#refuse(reason),
      getTicket: async () => ({ user: "operator", ticket: (await api.drive()).ticket }),
    });
    setText(byId("drive-title"), t("desk.drive_of", { id: robot }));
    byId("drive").hidden = false;
    this.#showConnection();
    this.#connection.start();
    this.#driver.start();
    byId("drive").scrollIntoView({ block: "nearest" });
    byId("pad").focus();
  }

  stop() {
    if (this.#robot === null) return;
    this.#driver.stop();
    this.#connection.unadvertise();
    this.#connection.stop();
    this.#connection = null;
    this.#robot = null;
    clearTimeout(this.#refusalTimer);
    const hadFocus = byId("drive").contains(document.activeElement);
    byId("drive").hidden = true;
    if (hadFocus) (this.#opener.isConnected ? this.#opener : byId("robots-title")).focus();
  }

  #refuse(reason) {
    this.#show(t("desk.drive_refused", { reason }), "bad");
    clearTimeout(this.#refusalTimer);
    this.#refusalTimer = setTimeout(() => this.#showConnection(), REFUSED);
    this.#connection.signIn();
  }

  #showConnection() {
    if (this.#connection?.up) this.#show(t("desk.drive_hint"), "");
    else this.#show(t("desk.drive_connecting"), "bad");
  }

  #show(text, level) {
    setText(byId("drive-state"), text);
    byId("drive-state").dataset.level = level;
  }
}
