#include "ir/deafness.h"
#include "ir/hit_detector.h"

#include "testing.h"

namespace {

const uint32_t STARTS[] = {0, 1000, UINT32_MAX - 250};  // the last: the clock wraps within the pulse

// The sensor pin and what the detector makes of it, ms by ms.
struct Sensor {
  explicit Sensor(uint32_t start) : now(start) {}
  void run(uint32_t ms, bool light, bool own = false) {
    while (ms-- > 0) {
      hits += detector.update(light != lit, light, own, now++);
      lit = light;
    }
  }
  // A flash or a gap between two looks at the pin: only its edges are seen.
  void glitch() { hits += detector.update(true, lit, false, now++); }

  HitDetector detector;
  uint32_t now;
  bool lit = false;
  int hits = 0;
};

}  // namespace

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

TEST(light_is_a_hit_after_30_ms_and_not_before) {
  Sensor sensor(5000);
  sensor.run(100, false);
  sensor.run(30, true);
  CHECK_EQUAL(0, sensor.hits);
  sensor.run(1, true);
  CHECK_EQUAL(1, sensor.hits);
}

TEST(light_that_goes_out_before_30_ms_is_no_hit) {
  Sensor sensor(5000);
  for (int flash = 0; flash < 1000; ++flash) {
    sensor.run(29, true);
    sensor.run(flash % 40 + 1, false);
  }
  CHECK_EQUAL(0, sensor.hits);
}

TEST(each_of_many_pulses_is_a_hit) {
  for (uint32_t start : STARTS) {
    Sensor sensor(start);
    sensor.run(50, false);
    for (int pulse = 0; pulse < 20; ++pulse) {
      sensor.run(500, true);
      sensor.run(50, false);
    }
    CHECK_EQUAL(20, sensor.hits);
  }
}

TEST(flicker_at_the_edges_of_a_pulse_is_no_hit) {
  Sensor sensor(1000);
  sensor.run(50, false);
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

TEST(a_gap_of_up_to_14_ms_does_not_make_two_pulses_of_one) {
  for (uint32_t gap : {0u, 1u, 10u, 14u}) {
    Sensor sensor(1000);
    sensor.run(50, false);
    sensor.run(250, true);
    sensor.run(gap, false);
    if (gap == 0) sensor.glitch();
    sensor.run(250, true);
    CHECK_EQUAL(1, sensor.hits);
  }
}

TEST(pulses_count_at_most_once_in_100_ms) {
  Sensor sensor(0);
  sensor.run(50, false);
  for (int pulse = 0; pulse < 50; ++pulse) {
    sensor.run(32, true);
    sensor.run(18, false);
  }
  CHECK_EQUAL(25, sensor.hits);
}

TEST(a_flood_of_edges_is_no_hit_and_the_next_pulse_is_one) {
  Sensor sensor(0);
  for (int edge = 0; edge < 5000; ++edge) sensor.glitch();
  CHECK_EQUAL(0, sensor.hits);
  sensor.run(500, true);
  CHECK_EQUAL(1, sensor.hits);
}

TEST(light_that_was_there_at_power_on_is_no_hit) {
  HitDetector detector;
  for (uint32_t now = 0; now < 1000; ++now) CHECK(!detector.update(false, true, false, now));
}

TEST(light_that_has_come_while_nobody_looked_is_no_hit_and_the_next_pulse_is_one) {
  for (uint32_t start : STARTS) {
    Sensor sensor(start);
    sensor.run(100, false);
    sensor.now += 5000;
    sensor.lit = true;
    sensor.detector.reset();
    sensor.run(500, true);
    CHECK_EQUAL(0, sensor.hits);
    sensor.run(50, false);
    sensor.run(500, true);
    CHECK_EQUAL(1, sensor.hits);
  }
}

TEST(the_own_light_is_no_hit) {
  Sensor sensor(1000);
  sensor.run(50, false);
  for (int shot = 0; shot < 20; ++shot) {
    sensor.run(500, true, true);
    sensor.run(4, true);  // the sensor is slow
    sensor.run(46, false);
  }
  CHECK_EQUAL(0, sensor.hits);
  sensor.run(500, true);
  CHECK_EQUAL(1, sensor.hits);
}

TEST(a_pulse_that_outlasts_the_own_light_is_a_hit) {
  Sensor sensor(1000);
  sensor.run(50, false);
  sensor.run(400, false, true);
  sensor.run(100, true, true);
  sensor.run(400, true);
  CHECK_EQUAL(1, sensor.hits);
}

TEST(sunlight_is_one_hit_however_often_the_robot_fires) {
  Sensor sensor(1000);
  sensor.run(50, false);
  sensor.run(300, true);
  for (int shot = 0; shot < 20; ++shot) {
    sensor.run(500, true, true);
    sensor.run(50, true);
  }
  CHECK_EQUAL(1, sensor.hits);
}

TEST(after_long_darkness_across_the_clocks_wrap_a_pulse_still_counts) {
  Sensor sensor(UINT32_MAX - 100000);
  sensor.run(50, false);
  sensor.run(500, true);
  sensor.run(200000, false);
  sensor.run(500, true);
  CHECK_EQUAL(2, sensor.hits);
}

TEST(a_robot_is_deaf_while_light_has_not_ended_for_2_s) {
  for (uint32_t start : STARTS) {
    Deafness deafness;
    deafness.update(false, false, start);
    for (uint32_t ms = 0; ms < 5000; ++ms) CHECK_EQUAL(ms >= 2000, deafness.update(ms == 0, true, start + ms));
    CHECK(!deafness.update(true, false, start + 5000));
    CHECK(!deafness.update(true, true, start + 5001));
  }
}

TEST(shots_and_lamps_do_not_make_a_robot_deaf) {
  Deafness deafness;
  for (uint32_t now = 0; now < 60000; ++now) {
    CHECK(!deafness.update(false, now % 550 < 500, now));
  }
  for (uint32_t now = 60000; now < 120000; ++now) CHECK(!deafness.update(now % 10 == 0, true, now));
}
