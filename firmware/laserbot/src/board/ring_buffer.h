// Values between one writer and one reader, of which one may be an interrupt. Nothing here touches the hardware.
#pragma once

#include <stdint.h>

// Holds SIZE - 1 values. SIZE is a power of two up to 256: indices are single bytes, so an interrupt never sees half of
// one. They are masked when they are used: one wrong bit of an index must not write beyond the buffer.
template <typename Value, uint16_t SIZE>
class RingBuffer {
  static_assert(SIZE >= 2 && SIZE <= 256 && (SIZE & (SIZE - 1)) == 0, "SIZE must be a power of two from 2 to 256");

 public:
  bool empty() const { return ((head_ - tail_) & MASK) == 0; }
  uint8_t room() const { return static_cast<uint8_t>(tail_ - head_ - 1) & MASK; }

  // Only with room() > 0.
  void put(Value value) {
    values_[head_ & MASK] = value;
    head_ = (head_ + 1) & MASK;
  }

  // Only if not empty().
  Value take() {
    const Value value = values_[tail_ & MASK];
    tail_ = (tail_ + 1) & MASK;
    return value;
  }

 private:
  static constexpr uint8_t MASK = SIZE - 1;

  // The values are volatile as well: the compiler must not store one after the index that makes it visible.
  volatile Value values_[SIZE];
  volatile uint8_t head_ = 0;
  volatile uint8_t tail_ = 0;
};
