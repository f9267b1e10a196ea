// The laser: one pulse of light for each shot.
#pragma once

#include <stdint.h>

constexpr uint32_t PULSE_MS = 500;

// Darkness between two pulses. Commands to shoot come every 25 ms: without it the light would be back at once, and a
// receiver would take two pulses for a long one. A shot that comes within the gap is fired at its end.
constexpr uint32_t GAP_MS = 50;

class Emitter {
 public:
  // Ignored while the light is on.
  void shoot() { wanted_ = wanted_ || !lit_; }

  // Returns whether the light has to be on; `now` in ms, may wrap.
  bool update(uint32_t now) {
    if (lit_ && now - changed_ >= PULSE_MS) {
      lit_ = false;
      changed_ = now;
    }
    if (wanted_ && now - changed_ >= GAP_MS) {
      wanted_ = false;
      lit_ = true;
      changed_ = now;
    }
    return lit_;
  }

 private:
  bool lit_ = false;
  bool wanted_ = false;
  uint32_t changed_ = 0 - GAP_MS;
};
