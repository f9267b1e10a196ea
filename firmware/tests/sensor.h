// The light sensor's pin in virtual time, and the firmware behind it as the Arduino runs it: edges are noted by an
// interrupt that is masked until the next tick, the loop looks at each edge and, within a packet, every 0.2 ms.
#pragma once

#include <stddef.h>

#include <vector>

#include "ir/decoder.h"
#include "ir/hit_detector.h"
#include "ir/repeats.h"

struct CodedSensor {
  // For `us` the pin is as it is with light, or without.
  void see(bool light, uint32_t us);

  // The marks and spaces of a packet, and then darkness.
  void see(const std::vector<uint32_t> &marks, uint32_t dark_us);

  std::vector<Hit> packets;  // all
  std::vector<Hit> hits;     // without repeats
  Decoder decoder;

 private:
  void note(uint64_t at);
  void packet(uint64_t at);

  Repeats repeats_;
  uint64_t now_ = 0;       // us
  uint64_t unmasked_ = 0;  // us
  uint64_t last_edge_ = 0;
  bool pin_ = false;
  bool latched_ = false;
};

struct PlainSensor {
  void see(bool light, uint32_t us);

  HitDetector detector;
  int hits = 0;

 private:
  uint64_t now_ = 0;  // us
  uint64_t looked_ = 0;
  bool pin_ = false;
  bool edge_ = false;
};
