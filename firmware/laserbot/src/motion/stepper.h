// One stepper motor in half-steps, driven by a steady tick.
#pragma once

#include <stdint.h>

#include "../flash.h"
#include "movement.h"

// 5120 Hz is 3125 cycles of a 16 MHz clock, so both speeds come out exactly:
// a tick earns the speed as credit, a half-step costs 12800: 5120 * 2560 / 12800 = 1024/s, 5120 * 1792 / 12800 =
// 716.8/s.
constexpr uint16_t TICKS_PER_SECOND = 5120;
constexpr uint16_t STEP_COST = 12800;
constexpr uint16_t FULL_SPEED = 2560;
constexpr uint16_t SCALED_SPEED = 1792;

// A 28BYJ-48 starts at up to 600 half-steps/s (its data sheet's pull-in rate) and would slip at more. It starts at
// 600/s and gains 2.4/s a tick: full speed after 177 ticks, 35 ms. So a command still makes its 320 half-steps in 320
// ms.
constexpr uint16_t START_SPEED = 1500;
constexpr uint16_t ACCELERATION = 6;

// It may stop at once, but not turn round at once: it stands for 10 ms between the two directions.
constexpr uint8_t REVERSE_TICKS = 51;

// After its last half-step a motor is held for 49 ms until the rotor has settled, then its coils are switched off: the
// gear holds the wheel, and an idle robot does not drain its battery or heat its motors.
constexpr uint8_t HOLD_TICKS = 250;

class Stepper {
 public:
  // Replaces the target: `movement.steps` from the present position. 0 stops at once.
  void move(const WheelMovement &movement) {
    const int8_t direction = movement.steps < 0 ? -1 : 1;
    remaining_ = movement.steps < 0 ? -movement.steps : movement.steps;
    if (remaining_ > 0 && direction != direction_) {
      speed_ = 0;
      direction_ = direction;
    }
    target_ = movement.speed == Speed::SCALED ? SCALED_SPEED : FULL_SPEED;
  }

  void stop() { remaining_ = 0; }

  // One tick of 1/5120 s; returns whether the coils have changed.
  bool tick() {
    if (rest_ > 0) --rest_;
    // Credit is earned at a standstill too, up to one half-step: a movement starts with the next tick, but however
    // commands follow each other, two half-steps are never closer than 1/1024 s.
    if (credit_ < STEP_COST) credit_ += speed_ < START_SPEED ? START_SPEED : speed_;
    if (remaining_ == 0) {
      speed_ = 0;
      return hold_ > 0 && --hold_ == 0;
    }
    if (speed_ < START_SPEED) {
      if (turning_round()) return false;
      speed_ = START_SPEED;
    } else if (speed_ < target_) {
      speed_ += ACCELERATION;
    }
    if (speed_ > target_) speed_ = target_;
    if (credit_ < STEP_COST) return false;
    credit_ -= STEP_COST;
    --remaining_;
    phase_ = (phase_ + direction_) & 7;
    stepped_ = direction_;
    rest_ = REVERSE_TICKS;
    hold_ = HOLD_TICKS;
    return true;
  }

  // Whether ticks change nothing until the next move().
  bool at_rest() const { return remaining_ == 0 && hold_ == 0 && rest_ == 0 && credit_ >= STEP_COST; }

  // The four driver inputs IN1..IN4 as bits 0..3. The phase outlives the switching off: the next half-step follows the
  // last one, no step is lost. This is the order of AccelStepper's HALF4WIRE with its pins given as IN1, IN3, IN2, IN4.
  uint8_t coils() const {
    static const uint8_t half_steps[8] PROGMEM = {0x1, 0x3, 0x2, 0x6, 0x4, 0xc, 0x8, 0x9};
    return hold_ > 0 ? pgm_read_byte(&half_steps[phase_ & 7]) : 0;
  }

 private:
  bool turning_round() const { return rest_ > 0 && stepped_ != direction_; }

  uint16_t remaining_ = 0;
  uint16_t target_ = FULL_SPEED;
  uint16_t speed_ = 0;  // below START_SPEED: stands
  uint16_t credit_ = STEP_COST;
  int8_t direction_ = 1;
  int8_t stepped_ = 1;  // direction of the last half-step
  uint8_t phase_ = 0;
  uint8_t rest_ = 0;  // ticks until the rotor has settled so far that it may turn round
  uint8_t hold_ = 0;
};
