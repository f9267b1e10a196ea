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

// Writes one frame byte by byte, so that no second buffer of a frame's size is needed.
class FrameWriter {
 public:
  // Starts a frame of `length` payload bytes; exactly so many must follow before end().
  FrameWriter(uint16_t topic, uint16_t length);
  void u8(uint8_t value);
  void u16(uint16_t value);
  void u32(uint32_t value);
  // A ROS string: u32 length, then the characters without a terminator; `text` is in the flash.
  void string(const char *text);
  void end();

 private:
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
  // The line is silent: a frame that is not whole by now never will be. A whole one behind its start is found.
  void give_up();

  uint16_t topic() const;
  uint16_t length() const;
  const uint8_t *payload() const;

  // Frames with a wrong checksum, and times that the start of a frame had to be searched, since the start.
  uint16_t errors() const { return errors_; }
  uint16_t resyncs() const { return resyncs_; }

 private:
  void drop(size_t count);
  void align();

  uint8_t bytes_[FRAME_OVERHEAD + MAX_PAYLOAD];
  uint8_t used_ = 0;
  bool searching_ = false;
  uint16_t errors_ = 0;
  uint16_t resyncs_ = 0;
};

}  // namespace rosserial
