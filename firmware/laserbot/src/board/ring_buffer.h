// Bytes between one writer and one reader, of which one may be an interrupt. Nothing here touches the hardware.
#pragma once

#include <stdint.h>

// Holds SIZE - 1 bytes. SIZE is a power of two up to 256: indices are single bytes, so an interrupt never sees half of
// one.
template <uint16_t SIZE>
class RingBuffer {
  static_assert(SIZE >= 2 && SIZE <= 256 && (SIZE & (SIZE - 1)) == 0, "SIZE must be a power of two from 2 to 256");

 public:
  bool empty() const { return head_ == tail_; }
  uint8_t room() const { return static_cast<uint8_t>(tail_ - head_ - 1) & MASK; }

  // Only with room() > 0.
  void put(uint8_t byte) {
    bytes_[head_] = byte;
    head_ = (head_ + 1) & MASK;
  }

  // Only if not empty().
  uint8_t take() {
    const uint8_t byte = bytes_[tail_];
    tail_ = (tail_ + 1) & MASK;
    return byte;
  }

 private:
  static constexpr uint8_t MASK = SIZE - 1;

  // The bytes are volatile as well: the compiler must not store one after the index that makes it visible.
  volatile uint8_t bytes_[SIZE];
  volatile uint8_t head_ = 0;
  volatile uint8_t tail_ = 0;
};
