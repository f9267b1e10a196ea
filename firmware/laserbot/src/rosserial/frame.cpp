#include "frame.h"

#include <string.h>

#include "../counter.h"
#include "../flash.h"
#include "port.h"

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

enum class Verdict : uint8_t { POSSIBLE, IMPOSSIBLE, WRONG_CHECKSUM };

// Whether these bytes can be the beginning of a frame, or all of it.
Verdict judge(const uint8_t *bytes, size_t count) {
  if (count > 0 && bytes[0] != SYNC) return Verdict::IMPOSSIBLE;
  if (count > 1 && bytes[1] != VERSION) return Verdict::IMPOSSIBLE;
  if (count < TOPIC_AT) return Verdict::POSSIBLE;
  if (sum(bytes + LENGTH_AT, 3) != 0xff) return Verdict::WRONG_CHECKSUM;
  const size_t length = u16_at(bytes + LENGTH_AT);
  if (length > MAX_PAYLOAD) return Verdict::IMPOSSIBLE;
  // No host numbers topics so high: this is a frame right behind the header of one that was cut off.
  if (count >= PAYLOAD_AT && bytes[TOPIC_AT] == SYNC && bytes[TOPIC_AT + 1] == VERSION) return Verdict::IMPOSSIBLE;
  if (count < FRAME_OVERHEAD + length) return Verdict::POSSIBLE;
  return sum(bytes + TOPIC_AT, length + 3) == 0xff ? Verdict::POSSIBLE : Verdict::WRONG_CHECKSUM;
}

}  // namespace

FrameWriter::FrameWriter(uint16_t topic, uint16_t length) : sum_(0) {
  port::write(SYNC);
  port::write(VERSION);
  u16(length);
  end();
  sum_ = 0;
  u16(topic);
}

void FrameWriter::u8(uint8_t value) {
  sum_ += value;
  port::write(value);
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
  u32(strlen_P(text));
  while (const uint8_t character = pgm_read_byte(text++)) u8(character);
}

void FrameWriter::end() { port::write(0xff - sum_); }

void FrameParser::push(uint8_t byte) {
  if (used_ >= sizeof bytes_) used_ = 0;  // as below
  bytes_[used_++] = byte;
  align();
}

bool FrameParser::complete() const { return used_ >= FRAME_OVERHEAD && used_ >= FRAME_OVERHEAD + length(); }

void FrameParser::pop() {
  searching_ = false;
  drop(FRAME_OVERHEAD + length());
  align();
}

void FrameParser::give_up() {
  while (used_ > 0 && !complete()) {
    drop(1);
    align();
  }
}

uint16_t FrameParser::topic() const { return u16_at(bytes_ + TOPIC_AT); }

uint16_t FrameParser::length() const { return u16_at(bytes_ + LENGTH_AT); }

const uint8_t *FrameParser::payload() const { return bytes_ + PAYLOAD_AT; }

void FrameParser::drop(size_t count) {
  // Never true but for a disturbed RAM: what is moved or written beyond the end would disturb more of it.
  if (used_ > sizeof bytes_) used_ = 0;
  used_ = count < used_ ? used_ - count : 0;
  memmove(bytes_, bytes_ + count, used_);
}

// Keeps bytes_ the beginning of a frame: everything before the first byte that can start one is dropped.
void FrameParser::align() {
  size_t start = 0;
  while (start < used_) {
    const Verdict verdict = judge(bytes_ + start, used_ - start);
    if (verdict == Verdict::POSSIBLE) break;
    if (verdict == Verdict::WRONG_CHECKSUM) count(errors_);
    ++start;
  }
  if (start == 0) return;
  if (!searching_) count(resyncs_);
  searching_ = true;
  drop(start);
}

}  // namespace rosserial
