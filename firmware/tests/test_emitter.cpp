#include "ir/emitter.h"

#include "testing.h"

namespace {

const uint32_t STARTS[] = {0, 1000, UINT32_MAX - 250};  // the last: the clock wraps within the pulse

ShotTimes times(Mode mode, uint16_t cooldown = 500) { return ShotTimes(Setup{1, 0, mode, cooldown, 0}); }

}  // namespace

TEST(the_emitter_is_off_until_a_shot) {
  Emitter emitter;
  for (uint32_t now = 0; now < 2000; ++now) CHECK(!emitter.update(times(PLAIN), now));
}

TEST(a_shot_of_plain_light_is_one_pulse_of_500_ms) {
  for (uint32_t start : STARTS) {
    Emitter emitter;
    emitter.update(times(PLAIN), start - 1);
    emitter.shoot(times(PLAIN), start);
    for (uint32_t ms = 0; ms < 5000; ++ms) CHECK_EQUAL(ms < 500, emitter.update(times(PLAIN), start + ms));
  }
}

TEST(shots_during_a_pulse_neither_lengthen_it_nor_follow_it) {
  Emitter emitter;
  for (uint32_t ms = 0; ms < 2000; ++ms) {
    if (ms < 500 && ms % 25 == 0) emitter.shoot(times(PLAIN), ms);
    CHECK_EQUAL(ms < 500, emitter.update(times(PLAIN), ms));
  }
}

TEST(a_held_trigger_makes_equal_pulses_with_a_gap) {
  Emitter emitter;
  for (uint32_t ms = 0; ms < 10000; ++ms) {
    if (ms % 25 == 0) emitter.shoot(times(PLAIN), ms);
    CHECK_EQUAL(ms % 550 < 500, emitter.update(times(PLAIN), ms));
  }
}

TEST(a_held_trigger_sends_a_packet_each_cooldown) {
  for (uint16_t cooldown : {0, 80, 100, 500, 3000}) {
    const uint32_t period = cooldown < 80 ? 80 : cooldown;
    Emitter emitter;
    for (uint32_t ms = 0; ms < 20000; ++ms) {
      if (ms % 20 == 0) emitter.shoot(times(CODED, cooldown), ms);
      CHECK_EQUAL(ms % period < 30, emitter.update(times(CODED, cooldown), ms));
    }
  }
}

TEST(a_longer_cooldown_holds_for_plain_light_too) {
  Emitter emitter;
  for (uint32_t ms = 0; ms < 10000; ++ms) {
    if (ms % 25 == 0) emitter.shoot(times(PLAIN, 2000), ms);
    CHECK_EQUAL(ms % 2000 < 500, emitter.update(times(PLAIN, 2000), ms));
  }
}

TEST(a_shot_in_the_last_50_ms_of_the_cooldown_is_fired_at_its_end_and_an_earlier_one_never) {
  for (uint32_t at : {100u, 449u, 450u, 499u}) {
    Emitter emitter;
    emitter.shoot(times(CODED), 0);
    for (uint32_t ms = 0; ms < 2000; ++ms) {
      if (ms == at) emitter.shoot(times(CODED), ms);
      const bool second = at >= 450 && ms >= 500 && ms < 530;
      CHECK_EQUAL(ms < 30 || second, emitter.update(times(CODED), ms));
    }
  }
}

TEST(a_shot_after_the_cooldown_is_fired_at_once) {
  Emitter emitter;
  emitter.shoot(times(CODED), 0);
  for (uint32_t ms = 0; ms < 600; ++ms) emitter.update(times(CODED), ms);
  emitter.shoot(times(CODED), 600);
  CHECK(emitter.update(times(CODED), 600));
}

TEST(a_stopped_emitter_is_dark_and_still_cools_down) {
  Emitter emitter;
  emitter.shoot(times(PLAIN), 0);
  CHECK(emitter.update(times(PLAIN), 0));
  emitter.stop();
  CHECK(!emitter.update(times(PLAIN), 1));
  emitter.shoot(times(PLAIN), 300);
  for (uint32_t ms = 300; ms < 2000; ++ms) CHECK(!emitter.update(times(PLAIN), ms));
}
