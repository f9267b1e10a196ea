#include "sensor.h"

namespace {

constexpr uint64_t TICK_NS = 195313;
constexpr uint64_t LOOK_US = 200;

uint64_t next_tick(uint64_t us) { return ((us * 1000 / TICK_NS + 1) * TICK_NS + 999) / 1000; }

uint16_t length(uint64_t from, uint64_t to) { return (to / LIGHT_UNIT_US - from / LIGHT_UNIT_US) & 0x7fff; }

}  // namespace

void CodedSensor::see(bool light, uint32_t us) {
  if (latched_ && now_ >= unmasked_) {
    latched_ = false;
    note(unmasked_);
  }
  if (light != pin_) {
    pin_ = light;
    if (now_ >= unmasked_) {
      note(now_);
    } else {
      latched_ = true;
    }
  }
  now_ += us;
  if (latched_ && now_ >= unmasked_) {
    latched_ = false;
    note(unmasked_);
  }
  const uint64_t look = last_edge_ + END_US + LOOK_US;
  if (!pin_ && !latched_ && now_ >= look && decoder.dark(length(last_edge_, look))) packet(look);
}

void CodedSensor::see(const std::vector<uint32_t> &marks, uint32_t dark_us) {
  for (size_t i = 0; i < marks.size(); ++i) see(i % 2 == 0, marks[i]);
  see(false, dark_us);
}

void CodedSensor::note(uint64_t at) {
  unmasked_ = next_tick(at);
  if (decoder.feed(!pin_, length(last_edge_, at))) packet(at);
  last_edge_ = at;
}

void CodedSensor::packet(uint64_t at) {
  packets.push_back(decoder.hit());
  if (repeats_.is_new(decoder.hit().shooter, 500, at / 1000)) hits.push_back(decoder.hit());
}

void PlainSensor::see(bool light, uint32_t us) {
  edge_ = edge_ || light != pin_;
  pin_ = light;
  now_ += us;
  while (looked_ + LOOK_US <= now_) {
    looked_ += LOOK_US;
    hits += detector.update(edge_, pin_, false, looked_ / 1000);
    edge_ = false;
  }
}
