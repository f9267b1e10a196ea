// When to shoot: the light of one shot, then darkness until the cooldown has passed.
#pragma once

#include <stdint.h>

#include "../setup_msg.h"
#include "packet.h"

constexpr uint32_t PULSE_MS = 500;  // of plain light

// Darkness between two shots, at least. Commands to shoot come every 25 ms: without it the plain light would be back at
// once, and a receiver would take two pulses for a long one. A shot that comes so shortly before its time is fired
// then.
constexpr uint32_t GAP_MS = 50;

struct ShotTimes {
  explicit ShotTimes(const Setup &setup)
      : length(setup.mode == CODED ? PACKET_MS : PULSE_MS),
        period(setup.cooldown > length + GAP_MS ? setup.cooldown : length + GAP_MS) {}
  uint32_t length;  // ms of light
  uint32_t period;  // ms from the start of a shot to the next, at least
};

class Emitter {
 public:
  // `now` in ms, may wrap. Ignored while the last shot cools down.
  void shoot(const ShotTimes &times, uint32_t now) {
    wanted_ = wanted_ || !cooling_ || now - started_ >= times.period - GAP_MS;
  }

  // Returns whether this is within the light of a shot.
  bool update(const ShotTimes &times, uint32_t now) {
    const uint32_t since = now - started_;
    if (since >= times.length) lit_ = false;
    if (since >= times.period) cooling_ = false;
    if (wanted_ && !cooling_) {
      wanted_ = false;
      cooling_ = true;
      lit_ = true;
      started_ = now;
    }
    return lit_;
  }

  // The light goes out, and nothing is left to be fired.
  void stop() { lit_ = wanted_ = false; }

 private:
  uint32_t started_ = 0;
  bool cooling_ = false;
  bool lit_ = false;
  bool wanted_ = false;
};
