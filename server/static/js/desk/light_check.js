// The light check at its rim: rosbridge, as the operator, tells robots to flash and hears who has seen light.

import * as api from "./api.js";
import { setText } from "../common/dom.js";
import { socketAddress } from "../common/addresses.js";
import { t } from "../common/words.js";
import { NEUTRAL } from "../drive/keys.js";
import { LightPlan, checkResult, checkRow, whyNoCheck } from "./light_plan.js";
import { setCell, showRows, tableRow } from "./rows.js";

const INTERVAL = 50; // ms between two commands, as in a test drive

const COLUMNS = [["robot", t("desk.robot")], ["seen", t("desk.check_seen")], ["saw", t("desk.check_saw")]];

const byId = (id) => document.getElementById(id);

export class LightCheck {
  #plan = null;
  #socket = null;
  #timer = null;
  #ended = 0; // ms; when the check was over
  #robots = [];
  #why = "";

  constructor(onProblem) {
    byId("check-light").addEventListener("click", () => {
      if (this.#socket) this.#end(t("desk.check_stopped"));
      else if (this.#why === "") this.#start().catch((error) => onProblem(error));
    });
  }

  /** What the desk knows now. Nobody checks while players practise: their shots would be seen, too. A countdown or battle ends the check: its light would count. */
  show(game, robots, practice) {
    this.#robots = robots.filter(({ linked }) => linked).map(({ id }) => id);
    this.#why = whyNoCheck(game, robots, practice);
    if (this.#socket && game.state !== "stopped") this.#end(t("desk.check_battle"));
    this.#showButton();
  }

  async #start() {
    const { ticket } = await api.drive();
    if (this.#socket) return;
    const robots = this.#robots;
    const socket = new WebSocket(socketAddress("rosbridge"));
    [this.#socket, this.#plan] = [socket, null];
    const say = (operation) => socket.send(JSON.stringify(operation));
    socket.addEventListener("open", () => {
      say({ op: "auth", mac: ticket, client: "operator", dest: "", rand: "", t: 0, level: "", end: 0 });
      for (const robot of robots) {
        say({ op: "advertise", topic: command(robot), type: "laser_bot_battle/Robot_msg" });
        say({ op: "subscribe", topic: `/Robot${robot}/response`, type: "std_msgs/Empty" });
        say({ op: "subscribe", topic: `/Robot${robot}/hit`, type: "laser_bot_battle/Hit" });
      }
      this.#plan = new LightPlan(robots, performance.now());
      this.#timer = setInterval(() => this.#tick(say), INTERVAL);
      this.#tick(say);
    });
    socket.addEventListener("message", ({ data }) => socket === this.#socket && this.#hear(JSON.parse(data)));
    socket.addEventListener("close", () => socket === this.#socket && this.#end(t("desk.check_lost")));
    setText(byId("check-result"), "");
    this.#showButton();
  }

  #tick(say) {
    const turn = this.#plan.turn(performance.now());
    if (turn === null) {
      this.#end(checkResult(this.#plan));
      return;
    }
    say({ op: "publish", topic: command(turn.robot), msg: { ...NEUTRAL, shoot: turn.shoot } });
    this.#showRows(false);
  }

  #hear({ op, topic, level, msg }) {
    if (op === "status" && level === "error") return this.#end(t("desk.check_refused", { reason: msg }));
    const [, robot, what] = (op === "publish" && /^\/Robot(\d+)\/(hit|response)$/.exec(topic)) || [];
    return what && this.#plan.saw(Number(robot), what === "hit" ? msg.shooter : undefined, performance.now());
  }

  /** rosbridge stops the robots that this socket has driven. */
  #end(text) {
    clearInterval(this.#timer);
    const socket = this.#socket;
    this.#socket = null;
    socket.close();
    this.#ended = performance.now();
    if (this.#plan) this.#showRows(true);
    setText(byId("check-result"), text);
    this.#showButton();
  }

  #showButton() {
    const button = byId("check-light");
    const isUnderWay = this.#socket !== null;
    setText(button.querySelector("span"), t(isUnderWay ? "desk.check_stop" : "desk.check_start"));
    setText(button.querySelector("small"), isUnderWay ? "" : this.#why);
    button.setAttribute("aria-disabled", !isUnderWay && this.#why !== "");
  }

  #showRows(ended) {
    const now = ended ? this.#ended : performance.now();
    showRows(byId("check-rows"), this.#plan.robots, {
      key: String,
      make: () => tableRow(COLUMNS, []),
      fill: (row, robot) => {
        const { seen, saw } = checkRow(this.#plan, robot, now, ended);
        setCell(row, "robot", t("desk.robot_id", { id: robot }));
        setCell(row, "seen", seen);
        setCell(row, "saw", saw);
      },
    });
  }
}

const command = (robot) => `/Robot${robot}/command`;
