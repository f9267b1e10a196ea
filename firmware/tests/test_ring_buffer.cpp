#include "board/ring_buffer.h"

#include "testing.h"

TEST(bytes_leave_a_ring_buffer_in_their_order) {
  RingBuffer<uint8_t, 16> ring;
  uint8_t in = 0;
  uint8_t out = 0;
  for (int round = 0; round < 100; ++round) {
    for (int i = 0; i < 1 + round % 15; ++i) ring.put(in++);
    while (!ring.empty()) CHECK_EQUAL(out++, ring.take());
  }
  CHECK_EQUAL(in, out);
}

template <uint16_t SIZE>
static void check_capacity() {
  RingBuffer<uint8_t, SIZE> ring;
  for (unsigned offset = 0; offset < 2u * SIZE; ++offset) {
    CHECK(ring.empty());
    CHECK_EQUAL(SIZE - 1u, ring.room());
    for (unsigned i = 0; i < SIZE - 1u; ++i) ring.put(i);
    CHECK_EQUAL(0, ring.room());
    for (unsigned i = 0; i < SIZE - 1u; ++i) CHECK_EQUAL(static_cast<uint8_t>(i), ring.take());
    ring.put(0);
    ring.take();
  }
}

TEST(a_ring_buffer_holds_one_byte_less_than_its_size) {
  check_capacity<2>();
  check_capacity<64>();
  check_capacity<256>();
}
