#include "light.h"

#include <avr/interrupt.h>
#include <avr/io.h>
#include <util/atomic.h>

#include "../ir/packet.h"
#include "ring_buffer.h"
#include "ticks.h"

namespace {

constexpr uint8_t SENSOR = _BV(PD2);   // low = light (pull-up on)
constexpr uint8_t EMITTER = _BV(PD3);  // low = on

// Phase-correct PWM up to OCR2A: 16 MHz / (2 * 210) = 38.1 kHz. The pin is low while the counter is above OCR2B: a
// third of the time, as the receivers' data sheets have it.
constexpr uint8_t CARRIER_TOP = 210;
constexpr uint8_t CARRIER_ON_ABOVE = 140;
constexpr uint8_t CARRIER_MODE = _BV(WGM20);
constexpr uint8_t CARRIER_CLOCK = _BV(WGM22) | _BV(CS20);
constexpr uint8_t CARRIER_ON = _BV(COM2B1);

constexpr uint8_t CYCLES_PER_US = F_CPU / 1000000;
constexpr uint16_t FIRST_MARK_IN = 1000;  // cycles

constexpr uint16_t LIGHT_BIT = light::TIME_MASK + 1;

Envelope envelope;
RingBuffer<uint16_t, 64> edges;  // a packet has 30
volatile bool edges_lost = false;

}  // namespace

ISR(TIMER1_COMPB_vect) {
  const uint16_t us = envelope.next();
  if (us > 0 && envelope.carrier()) {
    TCNT2 = 0;
    TCCR2A = CARRIER_MODE | CARRIER_ON;
  } else {
    TCCR2A = CARRIER_MODE;
  }
  if (us > 0) {
    OCR1B += us * CYCLES_PER_US;
  } else {
    TIMSK1 &= ~_BV(OCIE1B);
  }
}

// INT0 comes before every other interrupt: a sensor that oscillates could stop the motors' tick and the UART for ever.
// So it is masked until the next tick (0.2 ms, also while the motors stand); an edge meanwhile is latched by the
// hardware and served then. The marks and spaces of a packet are longer.
ISR(INT0_vect) {
  const uint16_t at = board::cycles_in_interrupt() >> 8;
  const bool light = (PIND & SENSOR) == 0;
  EIMSK = 0;
  board::hurry();
  if (edges.room() > 0) {
    edges.put((at & light::TIME_MASK) | (light ? LIGHT_BIT : 0));
  } else {
    edges_lost = true;
  }
}

namespace light {

void begin() {
  PORTD |= EMITTER | SENSOR;  // the emitter's pin has to be high before it becomes an output
  DDRD = (DDRD & ~SENSOR) | EMITTER;
  TCCR2A = CARRIER_MODE;
  TCCR2B = CARRIER_CLOCK;
  TIMSK2 = 0;
  OCR2A = CARRIER_TOP;
  OCR2B = CARRIER_ON_ABOVE;
  EICRA = _BV(ISC00);  // both edges
  EIMSK = _BV(INT0);
}

void emit(bool on) {
  ATOMIC_BLOCK(ATOMIC_RESTORESTATE) {
    TIMSK1 &= ~_BV(OCIE1B);
    TCCR2A = CARRIER_MODE;
    if (on) {
      PORTD &= ~EMITTER;
    } else {
      PORTD |= EMITTER;
    }
  }
}

void send(uint16_t bits) {
  emit(false);
  ATOMIC_BLOCK(ATOMIC_RESTORESTATE) {
    envelope.start(bits);
    OCR1B = TCNT1 + FIRST_MARK_IN;
    TIFR1 = _BV(OCF1B);
    TIMSK1 |= _BV(OCIE1B);
  }
}

bool seen() { return (PIND & SENSOR) == 0; }

uint16_t clock() {
  uint16_t now = 0;
  ATOMIC_BLOCK(ATOMIC_RESTORESTATE) { now = board::cycles_in_interrupt() >> 8; }
  return now & TIME_MASK;
}

bool waiting() { return !edges.empty(); }

bool take_edge(Edge &edge, bool &lost) {
  lost = edges_lost;
  if (edges.empty()) return false;
  edges_lost = false;
  const uint16_t value = edges.take();
  edge = Edge{(value & LIGHT_BIT) != 0, static_cast<uint16_t>(value & TIME_MASK)};
  return true;
}

bool sound() {
  return (TCCR2A & ~CARRIER_ON) == CARRIER_MODE && TCCR2B == CARRIER_CLOCK && TIMSK2 == 0 && OCR2A == CARRIER_TOP &&
         OCR2B == CARRIER_ON_ABOVE && EICRA == _BV(ISC00) && (DDRD & (SENSOR | EMITTER)) == EMITTER &&
         (PORTD & SENSOR) != 0;
}

void tick() { EIMSK = _BV(INT0); }

}  // namespace light
