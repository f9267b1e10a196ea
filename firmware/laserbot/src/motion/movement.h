// What a command means for the two wheels.
#pragma once

#include <stdint.h>

// Half-steps of one command: more than a wheel makes until the next of 40 commands a second.
constexpr int16_t STEPS_PER_MOVEMENT = 320;

enum class Speed : uint8_t {
  FULL,    // 1024 half-steps/s
  SCALED,  // 0.7 of it: the inner wheel of a curve
};

struct WheelMovement {
  int16_t steps;  // half-steps from where the wheel is, 0 = stop now
  Speed speed;
};

struct Movement {
  WheelMovement left;
  WheelMovement right;
};

// linear_x 1 = forward, -1 = backward; angular_z 1 = right, -1 = left. The motors are mounted mirrored, so forward is
// left -320, right +320. Any other linear_x stops; any other angular_z counts as 0.
Movement movement_of(int8_t linear_x, int8_t angular_z);
