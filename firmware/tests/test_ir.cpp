#include "ir/emitter.h"
#include "ir/hit_detector.h"

#include "testing.h"

namespace {

const uint32_t STARTS[] = {0, 1000, UINT32_MAX - 250};  // the last: the clock wraps within the pulse

// The sensor pin and what the detector makes of it, ms by ms.
struct Sensor {
  explicit Sensor(uint32_t start) : now(start) {}
  void run(uint32_t ms, bool light) {
    while (ms-- > 0) {
      hits += detector.update(light && !lit, light, now++);
      lit = light;
    }
  }
  // A flash between two looks at the pin: only its edge is seen.
  void glitch() { hits += detector.update(true, lit, now++); }

  HitDetector detector;
  uint32_t now;
  bool lit = false;
  int hits = 0;
};

}  // namespace

TEST(the_laser_is_off_until_a_shot) {
  Emitter emitter;
  for (uint32_t now = 0; now < 2000; ++now) CHECK(!emitter.update(now));
}

TEST(a_shot_is_one_pulse_of_500_ms) {
  for (uint32_t start : STARTS) {
    Emitter emitter;
    emitter.update(start - 1);
    emitter.shoot();
    uint32_t on = 0;
    for (uint32_t ms = 0; ms < 5000; ++ms) {
      const bool lit = emitter.update(start + ms);
      CHECK_EQUAL(ms < 500, lit);
      on += lit;
    }
    CHECK_EQUAL(500u, on);
  }
}

TEST(shots_during_a_pulse_neither_lengthen_it_nor_follow_it) {
  Emitter emitter;
  for (uint32_t ms = 0; ms < 2000; ++ms) {
    if (ms < 500 && ms % 25 == 0) emitter.shoot();
    CHECK_EQUAL(ms < 500, emitter.update(ms));
  }
}

TEST(a_held_trigger_makes_equal_pulses_with_a_gap) {
  Emitter emitter;
  for (uint32_t ms = 0; ms < 10000; ++ms) {
    if (ms % 25 == 0) emitter.shoot();
    CHECK_EQUAL(ms % 550 < 500, emitter.update(ms));
  }
}

TEST(a_shot_within_the_gap_is_fired_at_its_end) {
  Emitter emitter;
  emitter.shoot();
  for (uint32_t ms = 0; ms < 2000; ++ms) {
    if (ms == 510) emitter.shoot();
    CHECK_EQUAL(ms < 500 || (ms >= 550 && ms < 1050), emitter.update(ms));
  }
}

TEST(a_shot_after_the_gap_is_fired_at_once) {
  Emitter emitter;
  emitter.shoot();
  for (uint32_t ms = 0; ms < 600; ++ms) emitter.update(ms);
  emitter.shoot();
  CHECK(emitter.update(600));
}

TEST(a_pulse_of_light_is_one_hit) {
  for (uint32_t start : STARTS) {
    Sensor sensor(start);
    sensor.run(100, false);
    sensor.run(500, true);
    CHECK_EQUAL(1, sensor.hits);
    sensor.run(1000, false);
    CHECK_EQUAL(1, sensor.hits);
  }
}

TEST(a_hit_is_reported_at_the_first_edge) {
  Sensor sensor(5000);
  sensor.glitch();
  CHECK_EQUAL(1, sensor.hits);
}

TEST(each_of_many_pulses_is_a_hit) {
  for (uint32_t start : STARTS) {
    Sensor sensor(start);
    for (int pulse = 0; pulse < 20; ++pulse) {
      sensor.run(500, true);
      sensor.run(50, false);
    }
    CHECK_EQUAL(20, sensor.hits);
  }
}

TEST(flicker_at_the_edges_of_a_pulse_is_no_hit) {
  Sensor sensor(1000);
  for (int pulse = 1; pulse <= 5; ++pulse) {
    for (int flicker = 0; flicker < 5; ++flicker) {
      sensor.run(1, true);
      sensor.run(5, false);
    }
    sensor.run(500, true);
    for (int flicker = 0; flicker < 5; ++flicker) {
      sensor.run(9, false);
      sensor.glitch();
    }
    sensor.run(50, false);
    CHECK_EQUAL(pulse, sensor.hits);
  }
}

TEST(short_pulses_count_at_most_once_in_100_ms) {
  Sensor sensor(0);
  for (int pulse = 0; pulse < 50; ++pulse) {
    sensor.run(5, true);
    sensor.run(15, false);
  }
  CHECK(sensor.hits >= 5);
  CHECK(sensor.hits <= 10);
}

TEST(a_flood_of_edges_is_one_hit_and_the_next_pulse_another) {
  Sensor sensor(0);
  for (int edge = 0; edge < 5000; ++edge) sensor.glitch();
  CHECK_EQUAL(1, sensor.hits);
  sensor.run(20, false);
  sensor.run(500, true);
  CHECK_EQUAL(2, sensor.hits);
}

TEST(light_that_was_there_at_power_on_is_no_hit) {
  HitDetector detector;
  for (uint32_t now = 0; now < 1000; ++now) CHECK(!detector.update(false, true, now));
}

TEST(after_long_darkness_across_the_clocks_wrap_a_pulse_still_counts) {
  Sensor sensor(UINT32_MAX - 100000);
  sensor.run(500, true);
  sensor.run(200000, false);
  sensor.run(500, true);
  CHECK_EQUAL(2, sensor.hits);
}
