#include "frame.h"

#include <string.h>

namespace rosserial {

namespace {

constexpr uint8_t SYNC = 0xff;
constexpr uint8_t VERSION = 0xfe;
constexpr size_t LENGTH_AT = 2;
constexpr size_t TOPIC_AT = 5;
constexpr size_t PAYLOAD_AT = 7;

uint8_t sum(const uint8_t *bytes, size_t count) {
  uint8_t total = 0;
  while (count-- > 0) total += *bytes++;
  return total;
}

uint16_t u16_at(const uint8_t *bytes) { return static_cast<uint16_t>(bytes[0] | bytes[1] << 8); }

bool can_be_frame(const uint8_t *bytes, size_t count) {
  if (count > 0 && bytes[0] != SYNC) return false;
  if (count > 1 && bytes[1] != VERSION) return false;
  if (count < TOPIC_AT) return true;
  if (sum(bytes + LENGTH_AT, 3) != 0xff) return false;
  const size_t length = u16_at(bytes + LENGTH_AT);
  if (length > MAX_PAYLOAD) return false;
  return count < FRAME_OVERHEAD + length || sum(bytes + TOPIC_AT, length + 3) == 0xff;
}

}  // namespace

FrameWriter::FrameWriter(Port &port, uint16_t topic, uint16_t length) : port_(port), sum_(0) {
  port_.write(SYNC);
  port_.write(VERSION);
  u16(length);
  end();
  sum_ = 0;
  u16(topic);
}

void FrameWriter::u8(uint8_t value) {
  sum_ += value;
  port_.write(value);
}

void FrameWriter::u16(uint16_t value) {
  u8(value & 0xff);
  u8(value >> 8);
}

void FrameWriter::u32(uint32_t value) {
  u16(value & 0xffff);
  u16(value >> 16);
}

void FrameWriter::string(const char *text) {
  u32(strlen(text));
  while (*text != '\0') u8(*text++);
}

void FrameWriter::end() { port_.write(0xff - sum_); }

void FrameParser::push(uint8_t byte) {
  bytes_[used_++] = byte;
  align();
}

bool FrameParser::complete() const { return used_ >= FRAME_OVERHEAD && used_ >= FRAME_OVERHEAD + length(); }

void FrameParser::pop() {
  drop(FRAME_OVERHEAD + length());
  align();
}

uint16_t FrameParser::topic() const { return u16_at(bytes_ + TOPIC_AT); }

uint16_t FrameParser::length() const { return u16_at(bytes_ + LENGTH_AT); }

const uint8_t *FrameParser::payload() const { return bytes_ + PAYLOAD_AT; }

void FrameParser::drop(size_t count) {
  used_ -= count;
  memmove(bytes_, bytes_ + count, used_);
}

// Keeps bytes_ the beginning of a frame: everything before the first byte that can start one is dropped.
void FrameParser::align() {
  size_t start = 0;
  while (start < used_ && !can_be_frame(bytes_ + start, used_ - start)) ++start;
  if (start > 0) drop(start);
}

}  // namespace rosserial
