// From the edges of the light sensor to packets of coded light, see docs/protocol-light.md.
#pragma once

#include <stdint.h>

#include "../counter.h"
#include "packet.h"

// All times are in units of 16 us: the board's clock gives them without a division.
constexpr uint16_t LIGHT_UNIT_US = 16;

// A receiver lengthens or shortens a mark by up to 160 us; the clock's unit and an interrupt that comes late add
// some 50. Half the distance of a 0 to a 1 is 300 us.
constexpr uint16_t TOLERANCE_US = 220;

// Darkness after the last bit, before a packet counts. It is longer than the longest space: a packet with more bits is
// none of ours.
constexpr uint16_t END_US = 1600;

class Decoder {
 public:
  // The sensor saw light (or darkness) for `length` and then the opposite. Returns whether a packet has ended before
  // it: hit() tells whose.
  bool feed(bool light, uint16_t length) {
    if (state_ == State::ENDING) {
      // The packet was whole: this is the darkness behind it.
      state_ = State::IDLE;
      if (!light && length >= END_US / LIGHT_UNIT_US) return good();
      count(bad_);
      return false;
    }
    if (state_ == State::IDLE || (light && is(length, HEADER_US))) {
      if (state_ != State::IDLE) count(bad_);
      const bool header = light && is(length, HEADER_US);
      state_ = header ? State::SPACE : State::IDLE;
      bits_ = 0;
      bits_read_ = 0;
      return false;
    }
    if (state_ == State::SPACE ? light || !is(length, SPACE_US) : !light || !take_bit(length)) {
      spoil();
    } else if (state_ == State::SPACE) {
      state_ = State::MARK;
    } else {
      state_ = bits_read_ == PACKET_BITS ? State::ENDING : State::SPACE;
    }
    return false;
  }

  // It has been dark for `length`. Returns whether that ends a packet.
  bool dark(uint16_t length) {
    if (state_ == State::IDLE || length < END_US / LIGHT_UNIT_US) return false;
    const bool whole = state_ == State::ENDING;
    if (!whole) spoil();
    state_ = State::IDLE;
    return whole && good();
  }

  // Whether a packet, or what may become one, has begun.
  bool begun() const { return state_ != State::IDLE; }

  // Forgets what has begun: something was missed, or is not to be seen.
  void reset() { state_ = State::IDLE; }

  // The same, and what has begun was light that is no packet.
  void spoil() {
    if (state_ != State::IDLE) count(bad_);
    state_ = State::IDLE;
  }

  Hit hit() const { return hit_of(bits_); }

  // Packets, and what had the header of one and broke, since the start.
  uint16_t packets() const { return packets_; }
  uint16_t bad() const { return bad_; }

 private:
  enum class State : uint8_t { IDLE, SPACE, MARK, ENDING };

  static bool is(uint16_t length, uint16_t us) {
    return length >= (us - TOLERANCE_US) / LIGHT_UNIT_US && length <= (us + TOLERANCE_US) / LIGHT_UNIT_US;
  }

  bool good() {
    if (bits_ >> (PACKET_BITS - 1) & 1) {
      count(bad_);
      return false;
    }
    count(packets_);
    return true;
  }

  bool take_bit(uint16_t length) {
    const bool one = is(length, ONE_US);
    if (!one && !is(length, ZERO_US)) return false;
    bits_ = bits_ << 1 | one;
    return ++bits_read_ <= PACKET_BITS;
  }

  State state_ = State::IDLE;
  uint8_t bits_read_ = 0;
  uint16_t bits_ = 0;
  uint16_t packets_ = 0;
  uint16_t bad_ = 0;
};
