// One colour for each robot, by its ID; by its name if it has none.

const COLOURS = ["#2de2ff", "#ffb52d", "#3dffa2", "#c77dff", "#ff7a3d", "#5b8cff", "#f2ff5c", "#ff7de0"];
export const OUT = "#6b7489"; // of robots that are out

export function colourOf(robot) {
  const number = robot.id ?? [...robot.name].reduce((sum, letter) => sum + letter.charCodeAt(0), 0);
  return COLOURS[number % COLOURS.length];
}
