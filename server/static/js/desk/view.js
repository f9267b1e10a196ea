// The desk's elements, set from the state. All that comes from names is set as text.

import { showBots } from "./bots.js";
import { element, setText } from "../common/dom.js";
import { iconButton, rowButton, setButton, setCell, showRows, tableRow } from "./rows.js";
import * as words from "./words.js";
import { t } from "../common/words.js";

const byId = (id) => document.getElementById(id);

const ROBOT = [
  ["id", t("desk.robot")], ["host", t("desk.host")], ["player", t("desk.player")], ["ping", t("desk.ping")], ["link", t("desk.link")],
  ["health", t("desk.health")],
];
const PLAYER = [
  ["name", t("desk.name")], ["robot", t("desk.robot")], ["life", t("desk.life")], ["ready", t("desk.ready")],
  ["seat", t("desk.seat")], ["page", t("desk.page")],
];
const WAITER = [["name", t("desk.name")], ["place", t("desk.place")], ["offer", t("desk.robot")]];

/**
 * Everything on the desk but its forms.
 * @param {object} state of GET /operator/api/state
 * @param {object} on what the rows' buttons do: service(id, inService), bot(id, level), identify(id), look(id), drive(id), signOut(name), ban(name), unban(name)
 */
export function showState(state, on) {
  showBattle(state.game);
  showRobots(state.robots, on);
  showBots(state, on.bot);
  showPlayers(state.players, on);
  showQueue(state.queue, on);
  showMessage(state.game.message);
  showBanned(state.names.banned, on);
  showSystem(state);
  showVisitors(state.visitors);
  showOverhead(state.overhead);
  showLog(state.log);
}

function showBattle(game) {
  const { title, clock, hint } = words.battleText(game);
  setText(byId("glance"), clock ? `${title} ${clock}` : title);
  setText(byId("battle-state"), title);
  setText(byId("battle-clock"), clock);
  setText(byId("battle-hint"), hint);
  byId("battle").dataset.state = game.paused ? "paused" : game.state;
  byId("glance").dataset.state = byId("battle").dataset.state;
  for (const [id, { action, text, why }] of Object.entries(words.battleButtons(game))) {
    const button = byId(id);
    button.dataset.order = action;
    setText(button.querySelector("span"), text);
    setText(button.querySelector("small"), why);
    button.setAttribute("aria-disabled", why !== ""); // `disabled` would take the focus away
  }
}

function showRobots(robots, on) {
  showRows(byId("robots-rows"), robots, {
    key: ({ id }) => String(id),
    make: ({ id }) => {
      const about = t("desk.of_robot", { id });
      const service = iconButton("power", "", about, () => on.service(id, service.dataset.to === "in"));
      const drive = iconButton("gamepad", t("desk.test_drive"), about, () => on.drive(id));
      const identify = iconButton("lamp", t("desk.identify"), about, () => on.identify(id));
      const look = iconButton("camera", t("desk.camera"), about, () => on.look(id));
      service.dataset.button = "service";
      drive.dataset.button = "drive";
      return tableRow(ROBOT, [identify, look, service, drive]);
    },
    fill: (row, robot) => {
      const { host, player, ping, link } = words.robotText(robot);
      setCell(row, "id", t("desk.robot_id", { id: robot.id }));
      setCell(row, "host", host);
      setCell(row, "player", player);
      setCell(row, "ping", ping);
      setCell(row, "link", link);
      setCell(row, "health", words.healthText(robot.health));
      const health = row.querySelector('[data-field="health"]');
      health.title = [health.textContent, words.healthDetails(robot.health)].filter(Boolean).join("\n");
      for (const field of ["host", "player"]) {
        const cell = row.querySelector(`[data-field="${field}"]`);
        cell.title = cell.textContent; // there may be no room for all of it
      }
      row.classList.toggle("is-out", !robot.in_service);
      const service = row.querySelector("[data-button=service]");
      service.dataset.to = robot.in_service ? "out" : "in";
      setButton(service, t(robot.in_service ? "desk.take_out" : "desk.put_in"));
      row.querySelector("[data-button=drive]").hidden = robot.in_service;
    },
  });
}

const personButtons = (name, on) => [
  rowButton(t("desk.sign_out_player"), name, () => on.signOut(name)),
  rowButton(t("desk.ban"), name, () => on.ban(name), "danger"),
];

function showPlayers(players, on) {
  // by robot: in the order of the ranking, rows would move under a finger
  const sorted = [...players].sort((one, other) => one.robot - other.robot);
  showRows(byId("players-rows"), sorted, {
    key: ({ name }) => name,
    make: ({ name }) => tableRow(PLAYER, personButtons(name, on)),
    fill: (row, player) => {
      const { life, ready, seat, page } = words.playerText(player);
      setCell(row, "name", player.name);
      setCell(row, "robot", t("desk.robot_id", { id: player.robot }));
      setCell(row, "life", life);
      setCell(row, "ready", ready);
      setCell(row, "seat", seat);
      setCell(row, "page", page);
    },
  });
}

function showQueue(queue, on) {
  showRows(byId("queue-rows"), queue, {
    key: ({ name }) => name,
    make: ({ name }) => tableRow(WAITER, personButtons(name, on)),
    fill: (row, waiter) => {
      setCell(row, "place", String(waiter.place));
      setCell(row, "name", waiter.name);
      setCell(row, "offer", words.waiterText(waiter));
    },
  });
}

function showMessage(text) {
  setText(byId("message-now"), text ? t("desk.message_now", { text }) : t("desk.no_message"));
  byId("message-clear").hidden = text === "";
}

function showBanned(banned, on) {
  showRows(byId("banned-rows"), banned, {
    key: (name) => name,
    make: (name) => element("li", {}, element("span", {}, name), rowButton(t("desk.unban"), name, () => on.unban(name))),
  });
}

function showSystem({ database, versions }) {
  setText(byId("database-url"), database.url);
  setText(byId("database-waiting"), String(database.waiting));
  const { problem, mishap } = database;
  byId("database-problem").hidden = problem === "" && mishap === "";
  setText(byId("database-problem"), problem ? t("desk.database_problem", { problem }) : mishap);
  for (const [part, version] of Object.entries(versions)) setText(byId(`version-${part}`), version);
}

function showOverhead({ troubles }) {
  byId("overhead-troubles").hidden = troubles.length === 0;
  setText(byId("overhead-troubles"), troubles.join("\n"));
}

function showVisitors({ one_address: address }) {
  byId("one-address").hidden = address === "";
  setText(byId("one-address"), address && t("desk.one_address", { address }));
}

function showLog(log) {
  const list = byId("log-rows");
  const version = JSON.stringify(log);
  if (list.dataset.version === version) return; // a selection in it stays
  list.dataset.version = version;
  list.replaceChildren(
    ...log.map(({ at, kind, text, by }) =>
      element(
        "li",
        { title: kind, className: by ? "by-operator" : "" },
        element("time", { dateTime: new Date(at * 1000).toISOString() }, words.timeText(at)),
        element("span", {}, text), // ends with the operator's name
      ),
    ),
  );
}

/** That the server does not answer since `since` (ms of Date), or, with null, that it does. */
export function showLost(since, error) {
  const line = byId("connection");
  line.hidden = since === null;
  document.body.classList.toggle("is-stale", since !== null);
  if (since === null) return;
  const text = t("desk.lost", { time: words.timeText(since / 1000) });
  setText(line, error.status ? `${text} ${error.message}` : text); // else it is the browser's own word for silence
}

/** Say what could not be done, until it is closed or something else works; `lang` if it is not in the page's language. */
export function showProblem(text, lang = "") {
  byId("problem").hidden = text === "";
  if (lang) byId("problem-text").lang = lang;
  else byId("problem-text").removeAttribute("lang");
  setText(byId("problem-text"), text);
}
