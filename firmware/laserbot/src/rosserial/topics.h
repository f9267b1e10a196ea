// The topics of this device, as it tells them to the host. All of it is in the flash.
#pragma once

#include <stdint.h>

namespace rosserial {

// Subscribers from 100, publishers from 125, as ros_lib numbers them on an ATmega328P.
constexpr uint8_t COMMAND = 100;
constexpr uint8_t SETUP = 101;
constexpr uint8_t IDENTIFY = 102;
constexpr uint8_t RESPONSE = 125;
constexpr uint8_t HIT = 126;
constexpr uint8_t BOARD = 127;

struct Topic {
  uint8_t id;
  const char *name;  // this and the next two in the flash
  const char *type;
  const char *md5;

  bool published() const { return id >= RESPONSE; }
};

constexpr uint8_t TOPICS = 6;

// In the order in which they are told: first the two of the tech manual, which every host knows.
Topic topic_at(uint8_t index);

}  // namespace rosserial
