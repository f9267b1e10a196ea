#include "motion/drive.h"
#include "motion/movement.h"

#include <stdlib.h>

#include <algorithm>
#include <map>

#include "testing.h"

namespace {

const std::vector<uint8_t> HALF_STEPS = {0x1, 0x3, 0x2, 0x6, 0x4, 0xc, 0x8, 0x9};

// What a motor on these coils does: follows them by half-steps, keeps its place when they are off.
class Motor {
 public:
  void see(uint8_t coils, uint32_t tick) {
    energised = coils != 0;
    if (!energised) return;
    const auto found = std::find(HALF_STEPS.begin(), HALF_STEPS.end(), coils);
    if (found == HALF_STEPS.end()) {
      ++slips;
      return;
    }
    const int phase = found - HALF_STEPS.begin();
    const int way = (phase - phase_ + 8) % 8;
    phase_ = phase;
    if (way == 0) return;
    if (way != 1 && way != 7) {
      ++slips;
      return;
    }
    position += way == 1 ? 1 : -1;
    if (last_step != 0) shortest = std::min(shortest, tick - last_step);
    last_step = tick;
  }
  int position = 0;
  int slips = 0;
  bool energised = false;
  uint32_t last_step = 0;
  uint32_t shortest = UINT32_MAX;

 private:
  int phase_ = 0;
};

// The drive with its two motors and the timer's ticks.
struct Rig {
  void run_ticks(uint32_t count) {
    while (count-- > 0) {
      ++now;
      const uint8_t left_before = drive.left_coils();
      const uint8_t right_before = drive.right_coils();
      const bool changed = drive.tick();
      CHECK(changed || (drive.left_coils() == left_before && drive.right_coils() == right_before));
      left.see(drive.left_coils(), now);
      right.see(drive.right_coils(), now);
    }
  }
  void run_ms(double ms) { run_ticks(static_cast<uint32_t>(ms * TICKS_PER_SECOND / 1000)); }
  void command(int8_t linear_x, int8_t angular_z) { drive.command(movement_of(linear_x, angular_z)); }

  Drive drive;
  Motor left;
  Motor right;
  uint32_t now = 0;
};

struct Row {
  int linear_x;
  int angular_z;
  int left;
  int right;
  bool left_scaled;
  bool right_scaled;
};

}  // namespace

TEST(the_movement_table) {
  const Row table[] = {
      // clang-format off: a line for each kind of movement
      {0, 0, 0, 0, false, false},         {0, 2, 0, 0, false, false},        {0, -128, 0, 0, false, false},
      {0, 1, -320, -320, false, false},   {0, -1, 320, 320, false, false},
      {1, 0, -320, 320, false, false},    {1, 1, -320, 320, false, true},    {1, -1, -320, 320, true, false},
      {-1, 0, 320, -320, false, false},   {-1, 1, 320, -320, false, true},   {-1, -1, 320, -320, true, false},
      {1, 2, -320, 320, false, false},    {-1, 127, 320, -320, false, false},
      {2, 0, 0, 0, false, false},         {2, 1, 0, 0, false, false},        {-2, -1, 0, 0, false, false},
      {127, 1, 0, 0, false, false},       {-128, 0, 0, 0, false, false},
      // clang-format on
  };
  for (const Row &row : table) {
    const Movement movement = movement_of(row.linear_x, row.angular_z);
    CHECK_EQUAL(row.left, movement.left.steps);
    CHECK_EQUAL(row.right, movement.right.steps);
    CHECK_EQUAL(row.left_scaled, movement.left.speed == Speed::SCALED);
    CHECK_EQUAL(row.right_scaled, movement.right.speed == Speed::SCALED);
  }
}

TEST(half_steps_energise_the_coils_in_the_order_of_half4wire) {
  Stepper stepper;
  CHECK_EQUAL(0, stepper.coils());
  stepper.move(WheelMovement{320, Speed::FULL});
  for (int step = 1; step <= 16; ++step) {
    while (!stepper.tick()) {
    }
    CHECK_EQUAL(HALF_STEPS[step % 8], stepper.coils());
  }
  stepper.move(WheelMovement{-320, Speed::FULL});
  for (int step = 15; step >= 0; --step) {
    while (!stepper.tick()) {
    }
    CHECK_EQUAL(HALF_STEPS[step % 8], stepper.coils());
  }
}

TEST(one_command_makes_320_half_steps_and_ends) {
  Rig rig;
  rig.command(1, 0);
  rig.run_ms(1000);
  CHECK_EQUAL(-320, rig.left.position);
  CHECK_EQUAL(320, rig.right.position);
  CHECK(rig.right.last_step <= 320 * TICKS_PER_SECOND / 1000);
}

TEST(a_movement_makes_no_more_half_steps_than_it_says) {
  Stepper stepper;
  stepper.move(WheelMovement{40, Speed::FULL});
  int steps = 0;
  for (int tick = 0; tick < 5120; ++tick) steps += stepper.tick() && stepper.coils() != 0;
  CHECK_EQUAL(40, steps);
}

TEST(ticks_at_rest_change_nothing_so_that_they_may_be_left_out) {
  Rig ticked, left_out;
  CHECK(ticked.drive.at_rest());
  for (Rig *rig : {&ticked, &left_out}) {
    rig->command(1, 1);
    CHECK(!rig->drive.at_rest());
    while (!rig->drive.at_rest()) rig->run_ticks(1);
    CHECK(!rig->left.energised && !rig->right.energised);
  }
  ticked.run_ticks(7);
  CHECK(ticked.drive.at_rest());
  for (Rig *rig : {&ticked, &left_out}) rig->command(-1, 0);
  for (int tick = 0; tick < 2000; ++tick) {
    for (Rig *rig : {&ticked, &left_out}) rig->run_ticks(1);
    CHECK_EQUAL(ticked.drive.left_coils(), left_out.drive.left_coils());
    CHECK_EQUAL(ticked.drive.right_coils(), left_out.drive.right_coils());
  }
}

TEST(a_motor_starts_slowly_and_is_at_full_speed_within_100_ms) {
  Rig rig;
  rig.command(1, 0);
  rig.run_ms(5);
  CHECK_EQUAL(3, rig.right.position);
  CHECK(rig.right.shortest >= 8);  // 640 half-steps/s
  rig.run_ms(35);
  const int before = rig.right.position;
  rig.command(1, 0);
  rig.run_ticks(512);
  const int faster = rig.right.position - before;
  CHECK(faster == 102 || faster == 103);  // 1024/s for 0.1 s
}

TEST(the_speed_never_grows_faster_than_the_ramp) {
  Rig rig;
  uint32_t last = 0;
  uint32_t interval = 10;
  rig.command(1, 0);
  for (int tick = 0; tick < 1000; ++tick) {
    const int before = rig.right.position;
    rig.run_ticks(1);
    if (rig.right.position == before) continue;
    if (last != 0) {
      CHECK(rig.now - last + 2 >= interval);
      interval = rig.now - last;
    }
    last = rig.now;
  }
  CHECK_EQUAL(5u, interval);
}

TEST(a_motor_stands_for_10_ms_before_it_turns_round_and_starts_slowly_again) {
  Rig rig;
  rig.command(1, 0);
  rig.run_ms(250);
  rig.command(1, 0);
  rig.run_ms(50);
  const int top = rig.right.position;
  const uint32_t turned = rig.right.last_step;
  rig.command(-1, 0);
  while (rig.right.position == top) rig.run_ticks(1);
  CHECK_EQUAL(top - 1, rig.right.position);
  CHECK_EQUAL(turned + 51, rig.now);
  rig.right.shortest = UINT32_MAX;
  rig.run_ms(5);
  CHECK(rig.right.shortest >= 8);
}

TEST(a_movement_starts_with_the_next_tick) {
  Rig rig;
  rig.run_ms(1000);
  rig.command(0, 1);
  rig.run_ticks(1);
  CHECK_EQUAL(-1, rig.left.position);
  CHECK_EQUAL(-1, rig.right.position);
  rig.run_ms(1000);
  rig.command(0, -1);
  rig.run_ticks(1);
  CHECK_EQUAL(-319, rig.left.position);
  CHECK_EQUAL(-319, rig.right.position);
}

TEST(with_40_commands_a_second_both_motors_make_1024_half_steps_a_second) {
  Rig rig;
  for (int command = 0; command < 40 * 11; ++command) {
    if (command == 40) rig.left.position = rig.right.position = 0;  // it has got up its speed
    rig.command(1, 0);
    rig.run_ticks(TICKS_PER_SECOND / 40);
  }
  CHECK_EQUAL(-10240, rig.left.position);
  CHECK_EQUAL(10240, rig.right.position);
  CHECK_EQUAL(5u, rig.left.shortest);
}

TEST(the_scaled_wheel_makes_7168_half_steps_in_10_s) {
  for (int8_t linear_x : {1, -1}) {
    for (int8_t angular_z : {1, -1}) {
      Rig rig;
      for (int command = 0; command < 40 * 11; ++command) {
        if (command == 40) rig.left.position = rig.right.position = 0;  // it has got up its speed
        rig.command(linear_x, angular_z);
        rig.run_ticks(TICKS_PER_SECOND / 40);
      }
      const int slow = abs(angular_z == 1 ? rig.right.position : rig.left.position);
      CHECK(slow == 7168 || slow == 7169);
      CHECK_EQUAL(10240, abs(angular_z == 1 ? rig.left.position : rig.right.position));
    }
  }
}

TEST(however_commands_follow_each_other_half_steps_are_never_too_close) {
  Rig rig;
  uint32_t random = 7;
  for (int command = 0; command < 20000; ++command) {
    random = random * 1664525 + 1013904223;
    rig.command(static_cast<int8_t>((random >> 20) % 3) - 1, static_cast<int8_t>((random >> 24) % 3) - 1);
    rig.run_ticks((random >> 28) + 1);
  }
  CHECK(rig.left.shortest >= 5);
  CHECK(rig.right.shortest >= 5);
  CHECK_EQUAL(0, rig.left.slips);
  CHECK_EQUAL(0, rig.right.slips);
}

TEST(neutral_stops_at_once) {
  for (int8_t linear_x : {0, 2, -128}) {
    Rig rig;
    rig.command(1, 0);
    rig.run_ms(100);
    const int left = rig.left.position;
    const int right = rig.right.position;
    CHECK(right > 85);
    rig.command(linear_x, 0);
    rig.run_ms(1000);
    CHECK_EQUAL(left, rig.left.position);
    CHECK_EQUAL(right, rig.right.position);
  }
}

TEST(a_command_replaces_the_one_before) {
  Rig rig;
  rig.command(1, 0);
  rig.run_ms(100);
  const int right = rig.right.position;
  rig.command(-1, 0);
  rig.run_ms(1000);
  CHECK_EQUAL(right - 311, rig.right.position);  // 10 ms to turn round
}

TEST(both_motors_stand_320_ms_after_the_last_command) {
  for (int8_t linear_x : {0, 1, -1}) {
    for (int8_t angular_z : {0, 1, -1}) {
      Rig rig;
      rig.command(linear_x, angular_z);
      rig.run_ms(250);
      rig.command(linear_x, angular_z);
      rig.run_ms(320);
      const int left = rig.left.position;
      const int right = rig.right.position;
      rig.run_ms(5000);
      CHECK_EQUAL(left, rig.left.position);
      CHECK_EQUAL(right, rig.right.position);
    }
  }
}

TEST(the_scaled_wheel_is_cut_off_by_the_dead_man) {
  Rig rig;
  rig.command(1, 1);
  rig.run_ms(1000);
  CHECK_EQUAL(-320, rig.left.position);
  CHECK_EQUAL(229, rig.right.position);  // 716.8/s * 0.32 s, but for its start
}

TEST(coils_are_held_a_while_and_then_switched_off) {
  Rig rig;
  rig.command(1, 0);
  rig.run_ms(100);
  rig.command(0, 0);
  rig.run_ms(40);
  CHECK(rig.left.energised);
  CHECK(rig.right.energised);
  rig.run_ms(10);
  CHECK(!rig.left.energised);
  CHECK(!rig.right.energised);
}

TEST(a_slow_wheel_keeps_its_coils_on) {
  Rig rig;
  for (int command = 0; command < 40; ++command) {
    rig.command(1, 1);
    for (int tick = 0; tick < TICKS_PER_SECOND / 40; ++tick) {
      rig.run_ticks(1);
      if (rig.right.position != 0) CHECK(rig.right.energised);
    }
  }
}

TEST(no_step_is_lost_by_switching_the_coils_off) {
  Rig rig;
  for (int command = 0; command < 50; ++command) {
    rig.command(1, 0);
    rig.run_ms(11 + command);
    rig.command(0, 0);
    rig.run_ms(60);
    CHECK(!rig.right.energised);
  }
  CHECK_EQUAL(0, rig.left.slips);
  CHECK_EQUAL(0, rig.right.slips);
  CHECK_EQUAL(rig.right.position, -rig.left.position);
}

TEST(at_power_on_nothing_moves_and_no_coil_is_on) {
  Rig rig;
  rig.run_ms(1000);
  CHECK_EQUAL(0, rig.left.position);
  CHECK(!rig.left.energised);
  CHECK(!rig.right.energised);
}
