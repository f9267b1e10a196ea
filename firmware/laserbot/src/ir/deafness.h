// Light without end: with the sun on its sensor a robot cannot see a shot.
#pragma once

#include <stdint.h>

// Four times the longest shot.
constexpr uint32_t DEAF_MS = 2000;

class Deafness {
 public:
  // `edge`: the light has changed since the last call; `light`: there is light now; `now` in ms, may wrap. Returns
  // whether the sensor has seen nothing but light for long.
  bool update(bool edge, bool light, uint32_t now) {
    if (edge || !light) lit_at_ = now;
    return now - lit_at_ >= DEAF_MS;
  }

 private:
  uint32_t lit_at_ = 0;
};
