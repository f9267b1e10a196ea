// Plain light: from what the sensor sees to hits, one for each pulse.
#pragma once

#include <stdint.h>

constexpr uint32_t MIN_HIT_INTERVAL_MS = 100;

// So long has the light to be steady. Lamps on the mains flicker every 10 or 20 ms, and remote controls faster.
constexpr uint32_t LIGHT_MS = 30;

// Darkness that ends a pulse. It is longer than a half period of the mains (10 ms): a lamp that dims a pulse in that
// rhythm does not make two of it.
constexpr uint32_t DARK_MS = 15;

// The own light is not seen for so long after its end: a sensor is slow.
constexpr uint32_t OWN_LIGHT_MS = 5;

class HitDetector {
 public:
  // Forgets what was seen before a time without looks.
  void reset() { *this = HitDetector(); }

  // `edge`: the light has changed since the last call; `light`: there is light now; `own`: the own emitter is on; `now`
  // in ms, may wrap. Returns whether this is a hit.
  bool update(bool edge, bool light, bool own, uint32_t now) {
    if (own) own_at_ = now;
    blind_ = own || (blind_ && now - own_at_ < OWN_LIGHT_MS);
    if (blind_) {
      // What was steady before goes on: sunlight is no pulse that begins when the own one ends.
      lit_ = steady_;
      return false;
    }
    if (edge || !light || !lit_) {
      if (steady_ && (edge || !light)) {
        steady_ = false;
        dark_at_ = now;
      }
      lit_ = light;
      lit_at_ = now;
      return false;
    }
    if (steady_ || now - lit_at_ < LIGHT_MS || now - hit_at_ < MIN_HIT_INTERVAL_MS) return false;
    steady_ = true;
    if (lit_at_ - dark_at_ < DARK_MS) return false;
    hit_at_ = now;
    return true;
  }

 private:
  // Light that was there before the first look is no pulse.
  bool lit_ = true;
  bool steady_ = true;
  bool blind_ = false;
  uint32_t lit_at_ = 0;
  uint32_t dark_at_ = 0;  // end of the last steady light
  uint32_t hit_at_ = 0 - MIN_HIT_INTERVAL_MS;
  uint32_t own_at_ = 0;
};
