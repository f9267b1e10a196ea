// The list of robots beside the floor: who plays each, and the life that is left.

import { colourOf, OUT } from "./colours.js";

/**
 * What the list says about each robot, in its order. Pure.
 * @param {object[]} robots of the view
 * @param {import("./roles.js").Roles} roles
 * @param {object} words of the page
 */
export function rows(robots, roles, words) {
  const order = [...robots].sort((a, b) => (a.id ?? Infinity) - (b.id ?? Infinity) || (a.name < b.name ? -1 : 1));
  return order.map((robot) => {
    const { player, out } = roles.of(robot) ?? {};
    return {
      badge: String(robot.id ?? "?"),
      name: player?.name ?? words.robot.replace("{n}", robot.id ?? "?"),
      state: stateOf(player, words),
      life: player?.ready && !out ? player.life : null,
      colour: out ? OUT : (player?.colour ?? colourOf(robot)),
      classes: { beam: robot.beam, lit: robot.lit, out: out === true, free: !player, idle: !player?.ready || out },
    };
  });
}

function stateOf(player, words) {
  if (!player) return "";
  if (player.out) return words.out;
  return player.ready ? `${player.life} %` : words.waiting;
}

/** Make the list show these rows; only what has changed is touched. */
export function showRows(list, wanted) {
  while (list.children.length > wanted.length) list.lastElementChild.remove();
  wanted.forEach((row, place) => {
    const item = list.children[place] ?? list.appendChild(newItem());
    const [badge, name, state, bar] = item.children;
    setText(badge, row.badge);
    setText(name, row.name);
    setText(state, row.state);
    bar.hidden = row.life === null;
    bar.firstElementChild.style.width = `${row.life ?? 0}%`;
    item.style.setProperty("--robot", row.colour);
    for (const [name_, on] of Object.entries(row.classes)) item.classList.toggle(name_, on);
  });
}

function newItem() {
  const item = document.createElement("li");
  const [badge, name, state, bar] = ["b", "span", "span", "i"].map((tag) => document.createElement(tag));
  name.className = "name";
  state.className = "state";
  bar.className = "life";
  bar.append(document.createElement("i"));
  item.append(badge, name, state, bar);
  return item;
}

function setText(element, text) {
  if (element.textContent !== text) element.textContent = text;
}
