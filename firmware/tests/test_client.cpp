#include "rosserial/client.h"

#include "line.h"
#include "robot_msg.h"
#include "setup_msg.h"
#include "testing.h"

using testing::bytes;
using testing::hex;

namespace {

const std::string TOPIC_REQUEST = "ff fe 00 00 ff 00 00 ff";
const std::string TIME_ANSWER = "ff fe 08 00 f7 0a 00 01 02 03 04 05 06 07 08 d1";
const std::string TX_STOP = "ff fe 00 00 ff 0b 00 f4";
const std::string FORWARD = "ff fe 03 00 fc 64 00 01 00 00 9a";

const std::string TIME_REQUEST = "ff fe 08 00 f7 0a 00 00 00 00 00 00 00 00 00 f5";
const std::string RESPONSE_INFO =
    "ff fe 48 00 b7 00 00 7d 00 08 00 00 00 72 65 73 70 6f 6e 73 65 0e 00 00 00 73 74 64 5f 6d 73 67 "
    "73 2f 45 6d 70 74 79 20 00 00 00 64 34 31 64 38 63 64 39 38 66 30 30 62 32 30 34 65 39 38 30 30 "
    "39 39 38 65 63 66 38 34 32 37 65 18 01 00 00 7f";
const std::string COMMAND_INFO =
    "ff fe 53 00 ac 01 00 64 00 07 00 00 00 63 6f 6d 6d 61 6e 64 1a 00 00 00 6c 61 73 65 72 5f 62 6f "
    "74 5f 62 61 74 74 6c 65 2f 52 6f 62 6f 74 5f 6d 73 67 20 00 00 00 61 61 38 31 32 37 38 33 36 30 "
    "65 31 62 64 64 31 66 66 63 65 30 61 34 65 66 65 30 61 65 31 39 39 18 01 00 00 78";
const std::string HIT_INFO =
    "ff fe 49 00 b6 00 00 7e 00 03 00 00 00 68 69 74 14 00 00 00 6c 61 73 65 72 5f 62 6f 74 5f 62 61 "
    "74 74 6c 65 2f 48 69 74 20 00 00 00 61 34 63 33 31 33 33 64 63 61 66 66 34 37 31 61 62 31 33 61 "
    "34 65 33 36 33 30 62 65 37 34 34 38 18 01 00 00 25";
const std::string BOARD_INFO =
    "ff fe 53 00 ac 00 00 7f 00 05 00 00 00 62 6f 61 72 64 1c 00 00 00 6c 61 73 65 72 5f 62 6f 74 5f "
    "62 61 74 74 6c 65 2f 42 6f 61 72 64 48 65 61 6c 74 68 20 00 00 00 63 65 39 33 30 32 32 34 34 32 "
    "61 38 61 33 38 63 66 30 39 34 62 62 61 33 61 35 30 32 61 31 61 31 18 01 00 00 7a";
const std::string SETUP_INFO =
    "ff fe 4d 00 b2 01 00 65 00 05 00 00 00 73 65 74 75 70 16 00 00 00 6c 61 73 65 72 5f 62 6f 74 5f "
    "62 61 74 74 6c 65 2f 53 65 74 75 70 20 00 00 00 64 61 38 62 64 39 34 36 38 34 39 66 34 36 36 32 "
    "63 37 65 63 33 33 62 38 31 34 63 30 31 36 35 64 18 01 00 00 a1";
const std::string IDENTIFY_INFO =
    "ff fe 48 00 b7 01 00 66 00 08 00 00 00 69 64 65 6e 74 69 66 79 0e 00 00 00 73 74 64 5f 6d 73 67 "
    "73 2f 45 6d 70 74 79 20 00 00 00 64 34 31 64 38 63 64 39 38 66 30 30 62 32 30 34 65 39 38 30 30 "
    "39 39 38 65 63 66 38 34 32 37 65 18 01 00 00 a8";
const std::string FIRST_PART = TIME_REQUEST + " " + RESPONSE_INFO + " " + COMMAND_INFO;
const std::string NEGOTIATION = FIRST_PART + " " + HIT_INFO + " " + BOARD_INFO + " " + SETUP_INFO + " " + IDENTIFY_INFO;
const std::string HIT = "ff fe 00 00 ff 7d 00 82";

const BoardHealth HEALTHY = {};

struct Device {
  Device() { line = Line(); }

  void take_messages(uint32_t now) {
    while (client.message(now)) {
      if (client.topic() == rosserial::COMMAND)
        commands.push_back(hex(std::vector<uint8_t>(client.payload(), client.payload() + client.length())));
    }
  }

  void receive(const std::string &stream, uint32_t now) {
    take_messages(now);
    for (uint8_t byte : bytes(stream)) {
      client.receive(byte, now);
      take_messages(now);
    }
    client.spin(now);
  }

  // The program's loop, from `start` to before `end`.
  void run(uint32_t start, uint32_t end) {
    for (uint32_t now = start; now != end; ++now) receive("", now);
  }

  void connect(uint32_t now) {
    receive(TOPIC_REQUEST, now);
    for (int part = 0; part < 9; ++part) {
      line.take();
      client.spin(now);
    }
    CHECK(client.configured());
    line.take();
  }

  // What is sent while the line is emptied again and again.
  std::string all(uint32_t now) {
    std::string text = line.take();
    for (int part = 0; part < 9; ++part) {
      client.spin(now);
      const std::string more = line.take();
      if (!more.empty()) text += (text.empty() ? "" : " ") + more;
    }
    return text;
  }

  rosserial::Client client;
  std::vector<std::string> commands;
};

}  // namespace

TEST(nothing_is_sent_before_the_host_asks) {
  Device device;
  for (uint32_t now = 0; now < 60000; ++now) device.client.spin(now);
  CHECK_EQUAL(std::string(""), line.take());
  CHECK(!device.client.configured());
}

TEST(a_topic_request_is_answered_by_a_time_request_and_all_topics) {
  Device device;
  device.receive(TOPIC_REQUEST, 1000);
  CHECK_EQUAL(NEGOTIATION, device.all(1000));
  CHECK(device.client.configured());
}

TEST(the_topics_of_the_tech_manual_are_told_first_and_at_once) {
  Device device;
  device.receive(TOPIC_REQUEST, 1000);
  CHECK_EQUAL(FIRST_PART, line.take());
}

TEST(a_repeated_topic_request_is_answered_again) {
  Device device;
  device.connect(1000);
  device.receive(TOPIC_REQUEST, 1100);
  CHECK_EQUAL(NEGOTIATION, device.all(1100));
  CHECK(device.client.configured());
}

TEST(an_answer_waits_until_the_line_has_room_for_its_first_part) {
  Device device;
  line.free = 186;
  device.receive(TOPIC_REQUEST, 1000);
  CHECK_EQUAL(0u, line.sent.size());
  line.free = 187;
  device.client.spin(1001);
  CHECK_EQUAL(FIRST_PART, line.take());
}

TEST(the_other_topics_are_told_one_by_one_as_the_line_has_room) {
  Device device;
  line.free = 187;
  device.receive(TOPIC_REQUEST, 1000);
  CHECK_EQUAL(FIRST_PART, line.take());
  const size_t length = bytes(HIT_INFO).size();
  line.free = length - 1;
  device.client.spin(1001);
  CHECK_EQUAL(0u, line.sent.size());
  line.free = length + 3;
  device.client.spin(1002);
  CHECK_EQUAL(HIT_INFO, line.take());
  CHECK(!device.client.configured());
  CHECK_EQUAL(BOARD_INFO + " " + SETUP_INFO + " " + IDENTIFY_INFO, device.all(1003));
  CHECK(device.client.configured());
}

TEST(requests_while_the_line_is_busy_get_one_answer) {
  Device device;
  line.free = 0;
  for (uint32_t now = 1000; now < 1010; ++now) device.receive(TOPIC_REQUEST, now);
  line.free = 255;
  CHECK_EQUAL(NEGOTIATION, device.all(1010));
}

TEST(a_request_in_the_middle_of_an_answer_is_answered_from_the_start) {
  Device device;
  device.receive(TOPIC_REQUEST, 1000);
  CHECK_EQUAL(FIRST_PART, line.take());
  device.receive(TOPIC_REQUEST, 1005);
  CHECK_EQUAL(NEGOTIATION, device.all(1005));
}

TEST(a_device_that_has_started_tells_its_topics_unasked_and_then_waits_for_a_host) {
  Device device;
  device.client.announce();
  CHECK_EQUAL(NEGOTIATION, device.all(0));
  device.client.publish_response();
  device.run(0, 60000);
  CHECK_EQUAL(std::string(""), line.take());
  CHECK(!device.client.configured());
}

TEST(a_host_that_answers_a_device_that_has_started_is_connected) {
  for (const std::string &answer : {TIME_ANSWER, TOPIC_REQUEST}) {
    Device device;
    device.client.announce();
    device.all(0);
    device.receive(answer, 20);
    CHECK(device.client.configured());
  }
}

TEST(a_host_that_answers_before_all_topics_are_told_is_connected_then) {
  Device device;
  device.client.announce();
  device.client.spin(0);
  CHECK_EQUAL(FIRST_PART, line.take());
  device.receive(TIME_ANSWER, 20);
  CHECK(!device.client.configured());
  device.all(20);
  CHECK(device.client.configured());
}

TEST(a_command_reaches_the_program) {
  Device device;
  device.receive(FORWARD, 1000);
  CHECK_EQUAL(1u, device.commands.size());
  CHECK_EQUAL(std::string("01 00 00"), device.commands.at(0));
}

TEST(messages_on_unknown_topics_are_ignored) {
  Device device;
  device.receive("ff fe 03 00 fc 65 00 01 00 00 99", 1000);
  device.receive("ff fe 00 00 ff 06 00 f9", 1000);
  CHECK(device.commands.empty());
  CHECK_EQUAL(std::string(""), line.take());
}

TEST(half_a_frame_is_forgotten_after_20_ms_of_silence) {
  Device device;
  device.receive("ff fe 10 00 ef 64 00 01", 1000);
  device.receive(FORWARD, 1021);
  CHECK_EQUAL(1u, device.commands.size());
}

TEST(a_command_behind_half_a_frame_counts_as_soon_as_the_line_is_silent) {
  Device device;
  device.receive("ff fe 10 00 ef 64 00 " + FORWARD, 1000);
  device.run(1001, 1021);
  CHECK(device.commands.empty());
  device.receive("", 1021);
  CHECK_EQUAL(1u, device.commands.size());
}

TEST(a_frame_may_have_pauses_of_20_ms) {
  Device device;
  uint32_t now = UINT32_MAX - 50;  // the clock wraps on the way
  for (uint8_t byte : bytes(FORWARD)) device.receive(testing::hex({byte}), now += 20);
  CHECK_EQUAL(1u, device.commands.size());
}

TEST(the_time_is_asked_every_2500_ms) {
  Device device;
  device.connect(1000);
  for (uint32_t now = 1000; now < 3500; ++now) device.client.spin(now);
  CHECK_EQUAL(std::string(""), line.take());
  device.client.spin(3500);
  CHECK_EQUAL(TIME_REQUEST, line.take());
  device.client.spin(5999);
  CHECK_EQUAL(std::string(""), line.take());
  device.client.spin(6000);
  CHECK_EQUAL(TIME_REQUEST, line.take());
}

TEST(a_time_request_waits_for_room) {
  Device device;
  device.connect(0);
  line.free = 15;
  device.client.spin(2500);
  CHECK_EQUAL(std::string(""), line.take());
  device.client.spin(2510);
  CHECK_EQUAL(TIME_REQUEST, line.take());
}

TEST(the_connection_is_given_up_11_s_after_the_last_time_answer) {
  Device device;
  const uint32_t start = UINT32_MAX - 5000;  // the clock wraps on the way
  device.connect(start);
  device.run(start, start + 3000);
  device.receive(TIME_ANSWER, start + 3000);
  device.run(start + 3001, start + 14001);
  CHECK(device.client.configured());
  device.client.spin(start + 14001);
  CHECK(!device.client.configured());
  line.take();
  device.run(start + 14002, start + 20000);
  CHECK_EQUAL(std::string(""), line.take());
}

TEST(a_clock_that_jumps_does_not_end_the_connection) {
  for (uint32_t bit = 0; bit < 32; ++bit) {
    Device device;
    device.connect(100000);
    device.run(100000, 101000);
    uint32_t now = 101000 ^ 1u << bit;
    for (int ms = 0; ms < 8000; ++ms) {
      device.receive(bytes(line.take()).empty() ? "" : TIME_ANSWER, ++now);
      CHECK(device.client.configured());
    }
  }
}

TEST(commands_alone_do_not_keep_the_connection) {
  Device device;
  device.connect(0);
  for (uint32_t now = 0; now <= 11001; now += 25) {
    device.receive(FORWARD, now);
    line.take();
  }
  device.client.spin(11001);
  CHECK(!device.client.configured());
}

TEST(a_connection_that_was_given_up_comes_back_with_the_next_request) {
  Device device;
  device.connect(0);
  device.run(0, 11002);
  CHECK(!device.client.configured());
  line.take();
  device.receive(TOPIC_REQUEST, 20000);
  CHECK_EQUAL(NEGOTIATION, device.all(20000));
  device.client.spin(22499);
  CHECK(device.client.configured());
}

TEST(the_round_trip_of_a_question_for_the_time_is_measured) {
  Device device;
  CHECK_EQUAL(0, device.client.round_trip());
  device.connect(1000);
  for (uint8_t byte : bytes(TIME_ANSWER)) device.client.receive(byte, rosserial::Now(1004, 1003500));
  CHECK(!device.client.message(rosserial::Now(1004, 1003500)));
  CHECK_EQUAL(3500, device.client.round_trip());
}

TEST(tx_stop_silences_the_device_until_the_next_request) {
  Device device;
  device.connect(0);
  device.receive(TX_STOP, 100);
  CHECK(!device.client.configured());
  device.client.publish_response();
  device.client.spin(5000);
  CHECK_EQUAL(std::string(""), line.take());
  device.receive(TOPIC_REQUEST, 6000);
  CHECK_EQUAL(NEGOTIATION, device.all(6000));
}

TEST(a_hit_is_sent) {
  Device device;
  device.connect(0);
  device.client.publish_response();
  device.client.spin(10);
  CHECK_EQUAL(HIT, line.take());
  device.client.spin(11);
  CHECK_EQUAL(std::string(""), line.take());
}

TEST(hits_wait_for_room_and_none_is_lost) {
  Device device;
  device.connect(0);
  line.free = 7;
  for (int i = 0; i < 3; ++i) device.client.publish_response();
  device.client.spin(10);
  CHECK_EQUAL(0u, line.sent.size());
  line.free = 17;
  device.client.spin(11);
  CHECK_EQUAL(HIT + " " + HIT, line.take());
  device.client.spin(12);
  CHECK_EQUAL(HIT, line.take());
}

TEST(a_hit_without_a_connection_is_not_reported_later) {
  Device device;
  device.client.publish_response();
  device.receive(TOPIC_REQUEST, 1000);
  CHECK_EQUAL(NEGOTIATION, device.all(1000));
}

TEST(a_hit_that_waits_when_the_connection_ends_is_not_reported_later) {
  Device device;
  device.connect(0);
  line.free = 0;
  device.client.publish_response();
  device.receive(TX_STOP, 100);
  line.free = 255;
  device.receive(TOPIC_REQUEST, 200);
  CHECK_EQUAL(NEGOTIATION, device.all(200));
}

TEST(a_hit_during_a_repeated_negotiation_follows_its_frames) {
  Device device;
  device.connect(0);
  line.free = 3;
  device.receive(TOPIC_REQUEST, 100);
  device.client.publish_response();
  line.free = 255;
  CHECK_EQUAL(NEGOTIATION + " " + HIT, device.all(101));
}

TEST(light_packets_are_published_as_they_came) {
  Device device;
  device.connect(0);
  device.client.publish_hit(Hit{5, 2, 3});
  device.client.publish_hit(Hit{127, 0, 15});
  device.client.spin(10);
  CHECK_EQUAL(std::string("ff fe 03 00 fc 7e 00 05 02 03 77 ff fe 03 00 fc 7e 00 7f 00 0f f3"), line.take());
}

TEST(eight_light_packets_wait_for_room) {
  Device device;
  device.connect(0);
  line.free = 0;
  for (uint8_t shooter = 1; shooter <= 9; ++shooter) device.client.publish_hit(Hit{shooter, 0, 0});
  device.client.spin(10);
  line.free = 255;
  device.client.spin(11);
  CHECK_EQUAL(8u * 11, line.sent.size());
}

TEST(a_light_packet_without_a_connection_is_not_reported_later) {
  Device device;
  device.client.publish_hit(Hit{5, 2, 3});
  device.receive(TOPIC_REQUEST, 1000);
  CHECK_EQUAL(NEGOTIATION, device.all(1000));
}

TEST(the_health_of_the_board_is_published_field_by_field) {
  Device device;
  const BoardHealth health = {2,      1,      0x0403, 5,      CODED,  true,   0x09080706, 0x0b0a, 0x0d0c,
                              0x0f0e, 0x1110, 0x1312, 0x1514, 0x1716, 0x1918, 0x1b1a,     0x1d1c};
  CHECK(!device.client.publish_board(health, 10));
  device.connect(0);
  line.free = 38;
  CHECK(!device.client.publish_board(health, 10));
  line.free = 39;
  CHECK(device.client.publish_board(health, 10));
  CHECK_EQUAL(
      std::string("ff fe 1f 00 e0 7f 00 02 01 03 04 05 01 01 06 07 08 09 0a 0b 0c 0d 0e 0f 10 11 12 13 14 15 16 "
                  "17 18 19 1a 1b 1c 1d cb"),
      line.take());
}

TEST(a_host_that_does_not_know_the_health_message_is_left_alone) {
  Device device;
  device.connect(0);
  for (uint32_t now : {1000u, 2000u}) {
    CHECK(device.client.publish_board(HEALTHY, now));
    device.receive(TOPIC_REQUEST, now + 20);
    device.all(now + 20);
  }
  CHECK(!device.client.publish_board(HEALTHY, 3000));
}

TEST(a_host_that_asks_for_the_topics_now_and_then_gets_the_health_message) {
  Device device;
  device.connect(0);
  for (uint32_t now = 1000; now < 20000; now += 1000) {
    CHECK(device.client.publish_board(HEALTHY, now));
    device.receive(TOPIC_REQUEST, now + 500);
    device.all(now + 500);
  }
}

TEST(a_setup_with_values_that_make_no_sense_changes_nothing) {
  KeptSetup kept;
  Setup setup = kept.get();
  CHECK(decode_setup(bytes("05 02 01 f4 01 0f").data(), setup));
  CHECK_EQUAL(5, setup.id);
  CHECK_EQUAL(2, setup.team);
  CHECK_EQUAL(CODED, setup.mode);
  CHECK_EQUAL(500, setup.cooldown);
  CHECK_EQUAL(15, setup.damage);
  for (const char *wrong : {"ff 02 01 f4 01 0f", "05 04 01 f4 01 0f", "05 02 02 f4 01 0f", "05 02 01 f4 01 10"})
    CHECK(!decode_setup(bytes(wrong).data(), setup));
  CHECK_EQUAL(5, setup.id);
}

TEST(any_wrong_bit_of_the_kept_setup_is_noticed) {
  KeptSetup kept;
  kept.keep(Setup{5, 2, CODED, 500, 15});
  CHECK(kept.sound());
  uint8_t *raw = reinterpret_cast<uint8_t *>(&kept);
  for (size_t bit = 0; bit < 8 * sizeof kept; ++bit) {
    raw[bit / 8] ^= 1 << bit % 8;
    const Setup &now = kept.get();
    const bool same = now.id == 5 && now.team == 2 && now.mode == CODED && now.cooldown == 500 && now.damage == 15;
    CHECK(same || !kept.sound());
    raw[bit / 8] ^= 1 << bit % 8;
  }
}

TEST(robot_msg_fields_are_signed_bytes_and_a_bool) {
  const RobotMsg command = decode_robot_msg(bytes("ff 01 01").data());
  CHECK_EQUAL(-1, command.linear_x);
  CHECK_EQUAL(1, command.angular_z);
  CHECK(command.shoot);
  CHECK(!decode_robot_msg(bytes("00 00 00").data()).shoot);
}
