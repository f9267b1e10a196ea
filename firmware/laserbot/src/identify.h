// The operator asks which robot this is: for 2 s it flashes its LED and turns to and fro.
#pragma once

#include <stdint.h>

constexpr uint32_t IDENTIFY_MS = 2000;
constexpr uint32_t SWING_MS = 250;  // one way; the LED is on during every other one

class Identify {
 public:
  // `may_move`: no command is under way. `now` in ms, may wrap.
  void start(bool may_move, uint32_t now) {
    active_ = true;
    moving_ = may_move;
    started_ = now;
    turn_ = 0;
  }

  // A command has come: the wheels are the player's.
  void leave_wheels() { moving_ = false; }

  // Whether the wheels are to be told anew: turn() says what. Last they are told to stop.
  bool update(uint32_t now) {
    const uint32_t since = now - started_;
    if (since >= IDENTIFY_MS) active_ = false;
    const int8_t turn = !active_ ? 0 : (since / SWING_MS) % 2 == 0 ? 1 : -1;
    led_ = turn == 1;
    if (!moving_ || turn == turn_) return false;
    turn_ = turn;
    moving_ = active_;
    return true;
  }

  int8_t turn() const { return turn_; }  // as angular_z of a command
  bool led() const { return led_; }

 private:
  bool active_ = false;
  bool moving_ = false;
  bool led_ = false;
  int8_t turn_ = 0;
  uint32_t started_ = 0;
};
