#include "movement.h"

namespace {

WheelMovement wheel(int steps, Speed speed) { return WheelMovement{static_cast<int16_t>(steps), speed}; }

}  // namespace

Movement movement_of(int8_t linear_x, int8_t angular_z) {
  const bool right = angular_z == 1;
  const bool left = angular_z == -1;
  if (linear_x == 1 || linear_x == -1) {
    const int ahead = linear_x * STEPS_PER_MOVEMENT;
    return Movement{wheel(-ahead, left ? Speed::SCALED : Speed::FULL),
                    wheel(ahead, right ? Speed::SCALED : Speed::FULL)};
  }
  const int turn = linear_x == 0 ? (right - left) * STEPS_PER_MOVEMENT : 0;
  return Movement{wheel(-turn, Speed::FULL), wheel(-turn, Speed::FULL)};
}
