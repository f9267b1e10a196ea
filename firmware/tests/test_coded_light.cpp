#include "ir/packet.h"

#include "page.h"
#include "sensor.h"
#include "testing.h"

namespace {

Hit shot_of(Row row) {
  return Hit{static_cast<uint8_t>(std::stoi(row["shooter"])), static_cast<uint8_t>(std::stoi(row["team"])),
             static_cast<uint8_t>(std::stoi(row["damage"]))};
}

std::vector<uint32_t> marks_of(const Hit &shot) {
  Envelope envelope;
  envelope.start(packet_bits(shot));
  std::vector<uint32_t> marks;
  while (const uint16_t us = envelope.next()) {
    CHECK_EQUAL(marks.size() % 2 == 0, envelope.carrier());
    marks.push_back(us);
  }
  CHECK(!envelope.carrier());
  CHECK_EQUAL(0, envelope.next());
  return marks;
}

bool same(const Hit &a, const Hit &b) { return a.shooter == b.shooter && a.team == b.team && a.damage == b.damage; }

// What is received of a shot whose marks are longer by `us`.
std::vector<uint32_t> longer(std::vector<uint32_t> marks, int us) {
  for (size_t i = 0; i < marks.size(); ++i) marks[i] += i % 2 == 0 ? us : -us;
  return marks;
}

void check_is(const Hit &shot, const std::vector<uint32_t> &marks) {
  for (uint32_t phase = 0; phase < 200; phase += 7) {
    CodedSensor sensor;
    sensor.see(false, 10000 + phase);
    sensor.see(marks, 5000);
    CHECK_EQUAL(1u, sensor.packets.size());
    if (!sensor.packets.empty()) CHECK(same(shot, sensor.packets[0]));
    CHECK_EQUAL(1, sensor.decoder.packets());
    CHECK_EQUAL(0, sensor.decoder.bad());
  }
}

}  // namespace

TEST(shots_are_the_packets_of_the_page) {
  for (Row &row : table("Packets")) {
    const Hit shot = shot_of(row);
    std::string bits;
    for (int bit = PACKET_BITS - 1; bit >= 0; --bit) bits += packet_bits(shot) >> bit & 1 ? '1' : '0';
    CHECK_EQUAL(row["bits"], bits);
    CHECK(numbers(row["light"]) == marks_of(shot));
  }
}

TEST(the_packets_of_the_page_are_understood) {
  for (Row &row : table("Packets")) check_is(shot_of(row), numbers(row["light"]));
  for (Row &row : table("Packets as a receiver sees them")) check_is(shot_of(row), numbers(row["light"]));
}

TEST(any_shot_is_understood_however_the_receiver_bends_it) {
  uint32_t random = 3;
  for (int number = 0; number < 500; ++number) {
    random = random * 1664525 + 1013904223;
    const Hit shot = hit_of(random >> 8 & 0x1fff);
    check_is(shot, longer(marks_of(shot), static_cast<int>((random >> 21) % 321) - 160));
  }
}

TEST(what_the_page_says_is_no_packet_is_none) {
  for (Row &row : table("No packets")) {
    for (int bend : {-60, 0, 60}) {
      CodedSensor sensor;
      sensor.see(false, 10000);
      sensor.see(longer(numbers(row["light"]), row["what"].find("remote") == std::string::npos ? 0 : bend), 50000);
      CHECK_EQUAL(0u, sensor.packets.size());
    }
  }
}

TEST(a_packet_counts_when_it_has_been_dark_for_a_while) {
  const std::vector<uint32_t> marks = marks_of(Hit{5, 2, 3});
  CodedSensor sensor;
  sensor.see(false, 10000);
  sensor.see(marks, 1500);
  CHECK_EQUAL(0u, sensor.packets.size());
  sensor.see(false, 400);
  CHECK_EQUAL(1u, sensor.packets.size());
}

TEST(a_packet_after_a_broken_one_is_understood) {
  const std::vector<uint32_t> marks = marks_of(Hit{5, 2, 3});
  for (size_t kept = 1; kept < marks.size(); ++kept) {
    CodedSensor sensor;
    sensor.see(false, 10000);
    sensor.see(std::vector<uint32_t>(marks.begin(), marks.begin() + kept), kept % 2 == 0 ? 0 : 600);
    sensor.see(marks, 5000);
    CHECK(sensor.packets.size() == (kept % 2 == 0 ? sensor.packets.size() : 1u));
    sensor.see(marks, 5000);
    CHECK(!sensor.packets.empty());
  }
}

TEST(good_and_broken_packets_are_counted) {
  const std::vector<uint32_t> marks = marks_of(Hit{5, 2, 3});
  CodedSensor sensor;
  sensor.see(false, 10000);
  for (int number = 0; number < 3; ++number) sensor.see(marks, 20000);
  sensor.see(std::vector<uint32_t>(marks.begin(), marks.begin() + 9), 20000);
  sensor.see({560, 560, 560}, 20000);
  CHECK_EQUAL(3, sensor.decoder.packets());
  CHECK_EQUAL(1, sensor.decoder.bad());
}

TEST(two_packets_of_a_shooter_within_the_cooldown_are_one) {
  for (uint32_t start : {0u, 1000u, UINT32_MAX - 100}) {
    Repeats repeats;
    CHECK(repeats.is_new(5, 500, start));
    CHECK(!repeats.is_new(5, 500, start + 1));
    CHECK(!repeats.is_new(5, 500, start + 480));
    CHECK(repeats.is_new(5, 500, start + 495));  // its clock may be faster by 1 %
    CHECK(!repeats.is_new(5, 500, start + 700));
    CHECK(repeats.is_new(5, 500, start + 995));
  }
}

TEST(packets_of_different_shooters_are_different_shots) {
  Repeats repeats;
  for (uint8_t shooter = 0; shooter < 24; ++shooter) CHECK(repeats.is_new(shooter, 500, 1000 + 20 * shooter));
  for (uint8_t shooter = 0; shooter < 24; ++shooter) CHECK(!repeats.is_new(shooter, 500, 1479));
  for (uint8_t shooter = 100; shooter < 128; ++shooter) CHECK(repeats.is_new(shooter, 500, 3000));
}
