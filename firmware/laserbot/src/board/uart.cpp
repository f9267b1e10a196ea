#include "uart.h"

#include <avr/interrupt.h>
#include <avr/io.h>

#include "ring_buffer.h"

namespace {

RingBuffer<64> received;  // 11 ms of a line without pauses; the loop looks every 0.2 ms
RingBuffer<256> to_send;

}  // namespace

ISR(USART_RX_vect) {
  const uint8_t byte = UDR0;
  if (received.room() > 0) received.put(byte);
}

ISR(USART_UDRE_vect) {
  UDR0 = to_send.take();
  if (to_send.empty()) UCSR0B &= ~_BV(UDRIE0);
}

// 57600 baud, 8N1. Normal speed (58824) and not double speed (57143, nearer): the Uno's USB bridge at "57600" runs at
// the same 58824, and normal speed samples more tolerantly for bridges that are exact.
void Uart::begin() {
  UBRR0 = F_CPU / 16 / 57600 - 1;
  UCSR0A = 0;
  UCSR0C = _BV(UCSZ01) | _BV(UCSZ00);
  UCSR0B = _BV(RXEN0) | _BV(TXEN0) | _BV(RXCIE0);
}

size_t Uart::room() const { return to_send.room(); }

void Uart::write(uint8_t byte) {
  to_send.put(byte);
  // One instruction would not do here: the register lies beyond the reach of sbi, and the interrupt changes it as well.
  const uint8_t interrupts = SREG;
  cli();
  UCSR0B |= _BV(UDRIE0);
  SREG = interrupts;
}

bool Uart::read(uint8_t &byte) {
  if (received.empty()) return false;
  byte = received.take();
  return true;
}
