// How large robots are and how far they shoot: docs/build-a-robot.md, "Dimensions"; the virtual ones keep to it.

export const DIMENSIONS = {
  robot_radius: 0.075, // m, of the round chassis, wheels included
  beam_range: 0.9, // m from the emitter
  beam_half_angle: (8 * Math.PI) / 180,
};
