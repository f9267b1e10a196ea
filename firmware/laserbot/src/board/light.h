// The emitter on pin 3 and the light sensor on pin 2.
#pragma once

#include <stdint.h>

namespace light {

// The emitter is off; edges of the sensor are noted from now on.
void begin();

// Plain light: on or off. Off ends a packet, too.
void emit(bool on);

// Sends the packet with these bits (see ir/packet.h), by interrupt.
void send(uint16_t bits);

// Whether light falls on the sensor now.
bool seen();

// Times of edges are in units of 16 us (LIGHT_UNIT_US) and wrap after 524 ms.
constexpr uint16_t TIME_MASK = 0x7fff;
uint16_t clock();

struct Edge {
  bool light;  // what has begun
  uint16_t at;
};

// Whether there is an edge.
bool waiting();

// The same; takes it. `lost` is set if others before it were lost.
bool take_edge(Edge &edge, bool &lost);

// Whether the registers are as begin() has left them.
bool sound();

// For the motors' tick.
void tick();

}  // namespace light
