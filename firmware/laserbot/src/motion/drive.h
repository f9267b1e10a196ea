// Both motors and the dead-man: without a new command they stop, whatever the rest of the program does.
#pragma once

#include "stepper.h"

constexpr uint16_t DEAD_MAN_MS = 320;
constexpr uint16_t DEAD_MAN_TICKS = static_cast<uint32_t>(DEAD_MAN_MS) * TICKS_PER_SECOND / 1000;

class Drive {
 public:
  void command(const Movement &movement) {
    left_.move(movement.left);
    right_.move(movement.right);
    ticks_left_ = DEAD_MAN_TICKS;
  }

  // One tick of 1/5120 s; returns whether any coil has changed.
  bool tick() {
    if (ticks_left_ > 0 && --ticks_left_ == 0) {
      left_.stop();
      right_.stop();
    }
    const bool left_changed = left_.tick();
    const bool right_changed = right_.tick();
    return left_changed || right_changed;
  }

  // Whether ticks change nothing until the next command: what is left of the dead-man's time would stop nothing.
  bool at_rest() const { return left_.at_rest() && right_.at_rest(); }

  uint8_t left_coils() const { return left_.coils(); }
  uint8_t right_coils() const { return right_.coils(); }

 private:
  Stepper left_;
  Stepper right_;
  uint16_t ticks_left_ = 0;
};
