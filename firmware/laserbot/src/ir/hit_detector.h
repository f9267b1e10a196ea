// From flickering light on the sensor to hits: one per pulse of light, at most one per 100 ms.
#pragma once

#include <stdint.h>

constexpr uint32_t MIN_HIT_INTERVAL_MS = 100;

// A pulse has ended when the sensor has been dark and without edges for so long; shorter gaps are flicker of its edges.
constexpr uint32_t DARK_MS = 10;

class HitDetector {
 public:
  // `edge`: light has begun since the last call; `light`: there is light now; `now` in ms, may wrap. Returns whether
  // this is a hit. To be called more often than every DARK_MS.
  bool update(bool edge, bool light, uint32_t now) {
    if (armed_) {
      if (!edge) return false;
      armed_ = false;
      hit_at_ = now;
      lit_at_ = now;
      return true;
    }
    if (edge || light) {
      lit_at_ = now;
    } else {
      armed_ = now - lit_at_ >= DARK_MS && now - hit_at_ >= MIN_HIT_INTERVAL_MS;
    }
    return false;
  }

 private:
  bool armed_ = true;
  uint32_t hit_at_ = 0;
  uint32_t lit_at_ = 0;
};
