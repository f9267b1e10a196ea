// What else shines on a real floor: none of it is a hit, and a shot in between is one. In virtual time, an hour each.
#include <algorithm>
#include <functional>
#include <iostream>

#include "ir/packet.h"
#include "sensor.h"
#include "testing.h"

namespace {

const uint64_t HOUR = 3600000000u;  // us
const Hit SHOT = {42, 1, 9};
const int SHOTS = 60;

uint32_t random_state = 1;
uint32_t random_to(uint32_t limit) {
  random_state = random_state * 1664525 + 1013904223;
  return (random_state >> 8) % limit;
}

typedef std::vector<uint32_t> Light;  // us of light, then of darkness, and so on

Light packet(const Hit &shot) {
  Envelope envelope;
  envelope.start(packet_bits(shot));
  Light light;
  while (const uint16_t us = envelope.next()) light.push_back(us);
  return light;
}

Light lamp_100_hz() { return {5000, 5000}; }
Light half_wave_50_hz() { return {10000, 10000}; }
Light sun() { return {60000000, 0}; }

// A remote control's frame is followed by darkness until the next one, 110 ms after its start.
Light repeated(Light frame, uint32_t period) {
  uint32_t length = 0;
  for (uint32_t part : frame) length += part;
  frame.push_back(period - length);
  return frame;
}

Light nec() {
  Light frame = {9000, 4500};
  for (int bit = 0; bit < 32; ++bit) {
    frame.push_back(560);
    frame.push_back(random_to(2) ? 1690 : 560);
  }
  frame.push_back(560);
  return repeated(frame, 110000);
}

Light sony() {
  const int lengths[] = {12, 15, 20};
  Light frame = {2400};
  for (int bit = lengths[random_to(3)]; bit > 0; --bit) {
    frame.push_back(600);
    frame.push_back(random_to(2) ? 1200 : 600);
  }
  return repeated(frame, 45000);
}

Light rc5() {
  Light frame;
  bool lit = false;
  for (int bit = 0; bit < 14; ++bit) {
    const bool one = bit < 2 || random_to(2);
    for (bool half : {!one, one}) {
      if (frame.empty() && !half) continue;
      if (half == lit) {
        frame.back() += 889;
      } else {
        frame.push_back(889);
      }
      lit = half;
    }
  }
  if (!lit) frame.pop_back();
  return repeated(frame, 114000);
}

Light glitches() { return {1 + random_to(300), 1 + random_to(20000)}; }

struct Source {
  const char *name;
  Light (*next)();
  bool pauses;  // a shot can be told from it only in a pause of it
};

const Source SOURCES[] = {
    {"lamp, 100 Hz", lamp_100_hz, true}, {"half-wave lamp, 50 Hz", half_wave_50_hz, true},
    {"NEC remote control", nec, false},  {"Sony remote control", sony, false},
    {"RC5 remote control", rc5, false},  {"sun", sun, true},
    {"glitches", glitches, false},
};

// An hour of the source with SHOTS shots: shot() between two of its frames.
template <typename Sensor>
void shine(const Source &source, Sensor &sensor, const std::function<void()> &shot) {
  uint64_t passed = 0;
  int shots = 0;
  while (passed < HOUR) {
    const Light light = source.next();
    for (size_t i = 0; i < light.size(); ++i) {
      sensor.see(i % 2 == 0, light[i]);
      passed += light[i];
    }
    if (passed < HOUR / SHOTS * (shots + 1)) continue;
    ++shots;
    sensor.see(false, 3000);
    shot();
    sensor.see(false, 20000);
  }
}

}  // namespace

TEST(no_source_of_light_is_a_hit_of_coded_light_and_a_shot_in_between_counts) {
  for (const Source &source : SOURCES) {
    CodedSensor sensor;
    shine(source, sensor, [&sensor] { sensor.see(packet(SHOT), 3000); });
    int wrong = 0;
    for (const Hit &hit : sensor.hits) wrong += hit.shooter != SHOT.shooter;
    std::cout << "  coded, an hour of " << source.name << ": " << wrong << " false hits, " << sensor.hits.size() - wrong
              << " of " << SHOTS << " shots\n";
    CHECK_EQUAL(0, wrong);
    CHECK_EQUAL(static_cast<size_t>(SHOTS), sensor.hits.size());
  }
}

TEST(no_source_of_light_is_a_hit_of_plain_light_and_a_shot_in_between_counts) {
  for (const Source &source : SOURCES) {
    if (source.next == sun) continue;  // plain light cannot be told from it: the robot says that it is deaf
    PlainSensor sensor;
    shine(source, sensor, [&sensor] { sensor.see(true, 500000); });
    std::cout << "  plain, an hour of " << source.name << ": " << sensor.hits - SHOTS << " false hits\n";
    CHECK_EQUAL(SHOTS, sensor.hits);
  }
}

TEST(sun_from_the_start_on_is_no_hit_of_plain_light) {
  HitDetector detector;
  for (uint32_t now = 0; now < 3600000; ++now) CHECK(!detector.update(false, true, false, now));
}

TEST(a_hundred_thousand_glitches_are_no_hit) {
  CodedSensor coded;
  PlainSensor plain;
  for (int number = 0; number < 100000; ++number) {
    const uint32_t width = 1 + random_to(number % 10 == 0 ? 3000 : 300), gap = 1 + random_to(number % 3 ? 2000 : 30000);
    coded.see(true, width);
    coded.see(false, gap);
    plain.see(true, width);
    plain.see(false, gap);
  }
  CHECK_EQUAL(0u, coded.packets.size());
  CHECK_EQUAL(0, plain.hits);
  coded.see(false, 3000);
  coded.see(packet(SHOT), 3000);
  plain.see(false, 20000);
  plain.see(true, 500000);
  CHECK_EQUAL(1u, coded.hits.size());
  CHECK_EQUAL(1, plain.hits);
}

TEST(two_shooters_at_once_never_make_a_third_and_are_both_heard_afterwards) {
  int both = 0, lost = 0;
  for (int number = 0; number < 20000; ++number) {
    const Hit shots[2] = {hit_of(random_to(0x2000)), hit_of(random_to(0x2000))};
    const uint32_t offset = number % 2 == 0 ? random_to(1000) : random_to(30000);
    // Light is there while either of them shines.
    std::vector<std::pair<uint32_t, int>> edges;
    for (int shooter = 0; shooter < 2; ++shooter) {
      uint32_t at = shooter == 0 ? 0 : offset;
      int step = 1;
      edges.push_back({at, step});
      for (uint32_t part : packet(shots[shooter])) {
        at += part;
        step = -step;
        edges.push_back({at, step});
      }
    }
    std::sort(edges.begin(), edges.end());
    CodedSensor sensor;
    sensor.see(false, 10000 + random_to(200));
    int shining = 0;
    for (size_t i = 0; i + 1 < edges.size(); ++i) {
      shining += edges[i].second;
      if (edges[i + 1].first > edges[i].first) sensor.see(shining > 0, edges[i + 1].first - edges[i].first);
    }
    sensor.see(false, 5000);
    for (const Hit &hit : sensor.packets) {
      CHECK(hit.shooter == shots[0].shooter || hit.shooter == shots[1].shooter);
      CHECK(hit.team == shots[0].team || hit.team == shots[1].team);
    }
    both += sensor.packets.size() == 2;
    lost += sensor.packets.empty();
    const size_t before = sensor.packets.size();
    sensor.see(packet(shots[0]), 5000);
    sensor.see(packet(shots[1]), 5000);
    CHECK_EQUAL(before + 2, sensor.packets.size());
  }
  std::cout << "  20000 pairs of shots at once: both heard " << both << ", none " << lost << ", a third 0\n";
}
