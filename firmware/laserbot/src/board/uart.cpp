#include "uart.h"

#include <avr/interrupt.h>
#include <avr/io.h>
#include <util/atomic.h>

#include "../counter.h"
#include "../rosserial/port.h"
#include "ring_buffer.h"

namespace {

// 57600 baud. An ATmega328P at 16 MHz makes 58824 (+2.1 %) of it at normal speed or 57143 (-0.8 %) at double speed.
// The Uno's bridge, an ATmega16U2 at 16 MHz, runs at 58824 itself when it is asked for 57600: at normal speed the two
// agree exactly. A Nano's bridge (CH340, FT232R) runs at 57600: there double speed is within 1 %.
#ifdef ARDUINO_AVR_NANO
constexpr uint8_t DOUBLE_SPEED = _BV(U2X0);
constexpr uint16_t DIVISOR = 34;
#else
constexpr uint8_t DOUBLE_SPEED = 0;
constexpr uint16_t DIVISOR = 16;
#endif

constexpr uint8_t FORMAT = _BV(UCSZ01) | _BV(UCSZ00);  // 8N1
constexpr uint8_t ENABLED = _BV(RXEN0) | _BV(TXEN0) | _BV(RXCIE0);

RingBuffer<uint8_t, 64> received;  // 11 ms of a line without pauses; each byte wakes the loop
RingBuffer<uint8_t, 256> to_send;
uint16_t lost = 0;

}  // namespace

ISR(USART_RX_vect) {
  const bool overrun = UCSR0A & _BV(DOR0);  // of a byte before this one; to be read first
  const uint8_t byte = UDR0;
  if (overrun) count(lost);
  if (received.room() > 0) {
    received.put(byte);
  } else {
    count(lost);
  }
}

ISR(USART_UDRE_vect) {
  if (!to_send.empty()) UDR0 = to_send.take();
  if (to_send.empty()) UCSR0B &= ~_BV(UDRIE0);
}

namespace uart {

void begin() {
  UBRR0 = DIVISOR;
  UCSR0A = DOUBLE_SPEED;
  UCSR0C = FORMAT;
  UCSR0B = ENABLED;
}

bool waiting() { return !received.empty(); }

bool read(uint8_t &byte) {
  if (received.empty()) return false;
  byte = received.take();
  return true;
}

uint16_t overruns() {
  uint16_t count = 0;
  ATOMIC_BLOCK(ATOMIC_RESTORESTATE) { count = lost; }
  return count;
}

bool sound() {
  return UBRR0 == DIVISOR && (UCSR0A & _BV(U2X0)) == DOUBLE_SPEED && UCSR0C == FORMAT &&
         (UCSR0B & ~_BV(UDRIE0)) == ENABLED;
}

}  // namespace uart

namespace rosserial {
namespace port {

size_t room() { return to_send.room(); }

void write(uint8_t byte) {
  to_send.put(byte);
  // One instruction would not do here: the register lies beyond the reach of sbi, and the interrupt changes it as well.
  ATOMIC_BLOCK(ATOMIC_RESTORESTATE) { UCSR0B |= _BV(UDRIE0); }
}

}  // namespace port
}  // namespace rosserial
