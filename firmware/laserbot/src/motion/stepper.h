// One stepper motor in half-steps, driven by a steady tick.
#pragma once

#include <stdint.h>

#include "movement.h"

// 5120 Hz is 3125 cycles of a 16 MHz clock, so both speeds come out exactly:
// a tick earns 10 or 7 credits, a half-step costs 50: 5120 * 10 / 50 = 1024/s, 5120 * 7 / 50 = 716.8/s.
constexpr uint16_t TICKS_PER_SECOND = 5120;
constexpr uint8_t STEP_COST = 50;
constexpr uint8_t FULL_CREDIT = 10;
constexpr uint8_t SCALED_CREDIT = 7;

// After its last half-step a motor is held for 49 ms until the rotor has settled, then its coils are switched off: the
// gear holds the wheel, and an idle robot does not drain its battery or heat its motors.
constexpr uint8_t HOLD_TICKS = 250;

class Stepper {
 public:
  // Replaces the target: `movement.steps` from the present position. 0 stops at once.
  void move(const WheelMovement &movement) {
    remaining_ = movement.steps < 0 ? -movement.steps : movement.steps;
    direction_ = movement.steps < 0 ? -1 : 1;
    credit_per_tick_ = movement.speed == Speed::SCALED ? SCALED_CREDIT : FULL_CREDIT;
  }

  void stop() { remaining_ = 0; }

  // One tick of 1/5120 s; returns whether the coils have changed.
  bool tick() {
    // Credit is earned at a standstill too, up to one half-step: a movement starts with the next tick, but however
    // commands follow each other, two half-steps are never closer than 1/1024 s.
    if (credit_ < STEP_COST) credit_ += credit_per_tick_;
    if (remaining_ == 0) return hold_ > 0 && --hold_ == 0;
    if (credit_ < STEP_COST) return false;
    credit_ -= STEP_COST;
    --remaining_;
    phase_ = (phase_ + direction_) & 7;
    hold_ = HOLD_TICKS;
    return true;
  }

  // The four driver inputs IN1..IN4 as bits 0..3. The phase outlives the switching off: the next half-step follows the
  // last one, no step is lost. This is the order of AccelStepper's HALF4WIRE with its pins given as IN1, IN3, IN2, IN4.
  uint8_t coils() const {
    static const uint8_t half_steps[8] = {0x1, 0x3, 0x2, 0x6, 0x4, 0xc, 0x8, 0x9};
    return hold_ > 0 ? half_steps[phase_] : 0;
  }

 private:
  uint16_t remaining_ = 0;
  int8_t direction_ = 1;
  uint8_t credit_per_tick_ = FULL_CREDIT;
  uint8_t credit_ = STEP_COST;
  uint8_t phase_ = 0;
  uint8_t hold_ = 0;
};
