#include "rosserial/frame.h"

#include "line.h"
#include "testing.h"

using rosserial::FrameParser;
using rosserial::FrameWriter;
using testing::bytes;
using testing::hex;

namespace {

const std::string FORWARD = "ff fe 03 00 fc 64 00 01 00 00 9a";
const std::string BACK_LEFT_SHOOT = "ff fe 03 00 fc 64 00 ff ff 01 9c";
const std::string TOPIC_REQUEST = "ff fe 00 00 ff 00 00 ff";

struct Received {
  uint16_t topic;
  std::string payload;
};

// All frames that the parser finds in `stream`.
std::vector<Received> parse(const std::string &stream, FrameParser &parser) {
  std::vector<Received> frames;
  for (uint8_t byte : bytes(stream)) {
    parser.push(byte);
    while (parser.complete()) {
      const std::vector<uint8_t> payload(parser.payload(), parser.payload() + parser.length());
      frames.push_back(Received{parser.topic(), hex(payload)});
      parser.pop();
    }
  }
  return frames;
}

std::vector<Received> parse(const std::string &stream) {
  FrameParser parser;
  return parse(stream, parser);
}

void check_only_forward(const std::vector<Received> &frames) {
  CHECK_EQUAL(1u, frames.size());
  for (const auto &frame : frames) {
    CHECK_EQUAL(100, frame.topic);
    CHECK_EQUAL(std::string("01 00 00"), frame.payload);
  }
}

}  // namespace

TEST(a_command_is_parsed) { check_only_forward(parse(FORWARD)); }

TEST(payload_bytes_of_ff_are_no_start_of_a_frame) {
  const auto frames = parse(BACK_LEFT_SHOOT);
  CHECK_EQUAL(1u, frames.size());
  CHECK_EQUAL(std::string("ff ff 01"), frames.at(0).payload);
}

TEST(an_empty_payload_is_a_frame) {
  const auto frames = parse(TOPIC_REQUEST);
  CHECK_EQUAL(1u, frames.size());
  CHECK_EQUAL(0, frames.at(0).topic);
  CHECK_EQUAL(std::string(""), frames.at(0).payload);
}

TEST(frames_may_follow_each_other_without_a_pause) {
  const auto frames = parse(TOPIC_REQUEST + " " + FORWARD + " " + BACK_LEFT_SHOOT);
  CHECK_EQUAL(3u, frames.size());
  CHECK_EQUAL(0, frames.at(0).topic);
  CHECK_EQUAL(std::string("01 00 00"), frames.at(1).payload);
  CHECK_EQUAL(std::string("ff ff 01"), frames.at(2).payload);
}

TEST(a_wrong_length_checksum_is_no_frame) { CHECK(parse("ff fe 03 00 fb 64 00 01 00 00 9a").empty()); }

TEST(a_wrong_payload_checksum_is_no_frame) { CHECK(parse("ff fe 03 00 fc 64 00 01 00 00 9b").empty()); }

TEST(another_protocol_version_is_no_frame) { CHECK(parse("ff ff 03 00 fc 64 00 01 00 00 9a").empty()); }

TEST(a_frame_after_garbage_is_found) {
  check_only_forward(parse("00 41 fe ff 0d 0a " + FORWARD));
  check_only_forward(parse("ff " + FORWARD));
  check_only_forward(parse("ff fe " + FORWARD));
}

TEST(a_frame_after_any_cut_frame_is_found) {
  for (size_t kept = 1; kept < 11; ++kept) {
    // What a host sends next completes the cut frame wrongly; the second frame at the latest is whole again.
    const auto frames = parse(BACK_LEFT_SHOOT.substr(0, 3 * kept) + FORWARD);
    check_only_forward(frames);
  }
}

TEST(a_frame_after_one_with_a_wrong_checksum_is_found) {
  check_only_forward(parse("ff fe 03 00 fc 64 00 01 00 00 00 " + FORWARD));
}

TEST(a_frame_that_is_too_long_does_not_swallow_the_next) {
  check_only_forward(parse("ff fe 11 00 ee " + FORWARD));
  check_only_forward(parse("ff fe ff ff 01 " + FORWARD));
}

TEST(the_longest_payload_is_parsed) {
  const auto frames = parse("ff fe 10 00 ef 64 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 9b");
  CHECK_EQUAL(1u, frames.size());
  CHECK_EQUAL(16u * 3 - 1, frames.at(0).payload.size());
}

TEST(two_frames_inside_a_broken_one_are_both_found) {
  // The header claims 16 bytes, so the whole of both short frames is taken before its checksum proves wrong.
  const auto frames = parse("ff fe 10 00 ef 64 00 " + TOPIC_REQUEST + " " + TOPIC_REQUEST + " 00");
  CHECK_EQUAL(2u, frames.size());
}

TEST(any_noise_is_survived_and_frames_still_found_after_it) {
  FrameParser parser;
  uint32_t random = 1;
  for (int round = 0; round < 2000; ++round) {
    for (int i = 0; i < 50; ++i) {
      random = random * 1664525 + 1013904223;
      const uint8_t wild = random >> 24;
      parser.push(wild < 64 ? 0xff : wild < 128 ? 0xfe : wild < 160 ? wild & 0x0f : wild);
      while (parser.complete()) parser.pop();
    }
    // A half frame at the end of the noise may need up to 24 bytes to prove false.
    parse("00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00 00", parser);
    check_only_forward(parse(FORWARD, parser));
  }
}

TEST(half_a_frame_is_forgotten_when_the_line_is_silent) {
  FrameParser parser;
  parse("ff fe 10 00 ef 64 00", parser);
  parser.give_up();
  check_only_forward(parse(FORWARD, parser));
}

TEST(a_frame_behind_a_valid_header_is_found_at_once) {
  for (const char *header : {"ff fe 03 00 fc", "ff fe 08 00 f7", "ff fe 10 00 ef"})
    check_only_forward(parse(std::string(header) + " " + FORWARD));
}

TEST(a_frame_inside_a_longer_one_that_never_ends_is_found_when_the_line_is_silent) {
  for (const char *start : {"ff fe 10 00 ef 64", "ff fe 10 00 ef 64 00", "ff fe 10 00 ef ff ff fe 10 00 ef 64 00"}) {
    FrameParser parser;
    CHECK(parse(std::string(start) + " " + FORWARD, parser).empty());
    parser.give_up();
    CHECK(parser.complete());
    CHECK_EQUAL(100, parser.topic());
    parser.pop();
    CHECK(!parser.complete());
    check_only_forward(parse(FORWARD, parser));
  }
}

TEST(wrong_checksums_and_searches_are_counted) {
  FrameParser parser;
  parse(FORWARD + " " + FORWARD, parser);
  CHECK_EQUAL(0, parser.errors());
  CHECK_EQUAL(0, parser.resyncs());
  parse("00 41 42 " + FORWARD, parser);
  CHECK_EQUAL(0, parser.errors());
  CHECK_EQUAL(1, parser.resyncs());
  parse("ff fe 03 00 fc 64 00 01 00 00 9b " + FORWARD, parser);
  CHECK_EQUAL(1, parser.errors());
  CHECK_EQUAL(2, parser.resyncs());
}

TEST(a_hit_is_written_as_rosserial_frames_it) {
  line = Line();
  FrameWriter(125, 0).end();
  CHECK_EQUAL(std::string("ff fe 00 00 ff 7d 00 82"), line.take());
}

TEST(numbers_are_little_endian_and_strings_have_their_length_first) {
  line = Line();
  FrameWriter frame(0x0201, 10);
  frame.u32(0x04030201);
  frame.string("hi");
  frame.end();
  CHECK_EQUAL(std::string("ff fe 0a 00 f5 01 02 01 02 03 04 02 00 00 00 68 69 1f"), line.take());
}
