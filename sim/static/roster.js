// The list of robots beside the floor.

import { colourOf } from "./colours.js";

/** Make the list show `robots`; only what has changed is touched. */
export function showRobots(list, robots) {
  const order = [...robots].sort((a, b) => (a.id ?? Infinity) - (b.id ?? Infinity) || (a.name < b.name ? -1 : 1));
  while (list.children.length > order.length) list.lastElementChild.remove();
  order.forEach((robot, place) => {
    const item = list.children[place] ?? list.appendChild(newItem());
    const [badge, name, hits] = item.children;
    setText(badge, robot.id ?? "?");
    setText(name, robot.name);
    setText(hits, robot.hits);
    item.style.setProperty("--robot", colourOf(robot));
    item.classList.toggle("beam", robot.beam);
    item.classList.toggle("lit", robot.lit);
    item.classList.toggle("hit", robot.hits > 0);
  });
}

function newItem() {
  const item = document.createElement("li");
  const name = document.createElement("span");
  const hits = document.createElement("span");
  name.className = "name";
  hits.className = "hits";
  item.append(document.createElement("b"), name, hits);
  return item;
}

function setText(element, text) {
  if (element.textContent !== String(text)) element.textContent = text;
}
