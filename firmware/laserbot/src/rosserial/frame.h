// Frames of the rosserial protocol, version 2:
//
//   ff fe | length u16 LE | 255 - sum(length) mod 256 | topic id u16 LE | payload | 255 - sum(id, payload) mod 256
//
// http://wiki.ros.org/rosserial/Overview/Protocol
#pragma once

#include <stddef.h>
#include <stdint.h>

namespace rosserial {

constexpr size_t FRAME_OVERHEAD = 8;

// The longest message that is of use here is the host's time (8 bytes). A frame that claims more is treated as garbage,
// so that one broken length cannot swallow the commands behind it.
constexpr size_t MAX_PAYLOAD = 16;

// Where frames go to. A writer checks room() for the whole frame first: a frame is sent entirely or not at all.
class Port {
 public:
  // Bytes that can be written now without waiting.
  virtual size_t room() const = 0;
  virtual void write(uint8_t byte) = 0;
};

// Writes one frame byte by byte, so that no second buffer of a frame's size is needed.
class FrameWriter {
 public:
  // Starts a frame of `length` payload bytes; exactly so many must follow before end().
  FrameWriter(Port &port, uint16_t topic, uint16_t length);
  void u8(uint8_t value);
  void u16(uint16_t value);
  void u32(uint32_t value);
  // A ROS string: u32 length, then the characters without a terminator.
  void string(const char *text);
  void end();

 private:
  Port &port_;
  uint8_t sum_;
};

// Finds frames in a stream of bytes. After garbage, a half frame or a wrong checksum it looks for the next start of a
// frame among the bytes that it has already taken, so that the first whole frame after a fault is not lost.
class FrameParser {
 public:
  // Takes one byte. While complete() is true the frame must be taken away by pop() before the next push().
  void push(uint8_t byte);
  // Whether a whole frame with right checksums is at hand; topic(), length() and payload() describe it until pop().
  bool complete() const;
  void pop();
  // Forgets a frame that never got its end.
  void reset() { used_ = 0; }

  uint16_t topic() const;
  uint16_t length() const;
  const uint8_t *payload() const;

 private:
  void drop(size_t count);
  void align();

  uint8_t bytes_[FRAME_OVERHEAD + MAX_PAYLOAD];
  size_t used_ = 0;
};

}  // namespace rosserial
