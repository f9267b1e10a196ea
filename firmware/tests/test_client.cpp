#include "rosserial/client.h"

#include "robot_msg.h"
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
const std::string NEGOTIATION = TIME_REQUEST + " " + RESPONSE_INFO + " " + COMMAND_INFO;
const std::string HIT = "ff fe 00 00 ff 7d 00 82";

// The line to the host, with as much room as a test gives it.
class Line : public rosserial::Port {
 public:
  size_t room() const override { return free; }
  void write(uint8_t byte) override {
    CHECK(free > 0);
    --free;
    sent.push_back(byte);
  }
  std::string take() {
    const std::string text = hex(sent);
    sent.clear();
    free = 255;
    return text;
  }
  size_t free = 255;
  std::vector<uint8_t> sent;
};

std::vector<std::string> commands;

void remember(const uint8_t *payload, uint16_t length) {
  commands.push_back(hex(std::vector<uint8_t>(payload, payload + length)));
}

struct Device {
  Device()
      : client(line, rosserial::Topic{125, "response", "std_msgs/Empty", "d41d8cd98f00b204e9800998ecf8427e"},
               rosserial::Topic{100, "command", "laser_bot_battle/Robot_msg", "aa81278360e1bdd1ffce0a4efe0ae199"},
               remember) {
    commands.clear();
  }

  void receive(const std::string &stream, uint32_t now) {
    for (uint8_t byte : bytes(stream)) client.receive(byte, now);
    client.spin(now);
  }

  void connect(uint32_t now) {
    receive(TOPIC_REQUEST, now);
    CHECK(client.configured());
    line.take();
  }

  Line line;
  rosserial::Client client;
};

}  // namespace

TEST(nothing_is_sent_before_the_host_asks) {
  Device device;
  for (uint32_t now = 0; now < 60000; ++now) device.client.spin(now);
  CHECK_EQUAL(std::string(""), device.line.take());
  CHECK(!device.client.configured());
}

TEST(a_topic_request_is_answered_by_a_time_request_and_both_topics) {
  Device device;
  device.receive(TOPIC_REQUEST, 1000);
  CHECK_EQUAL(NEGOTIATION, device.line.take());
  CHECK(device.client.configured());
}

TEST(a_repeated_topic_request_is_answered_again) {
  Device device;
  device.connect(1000);
  device.receive(TOPIC_REQUEST, 1100);
  CHECK_EQUAL(NEGOTIATION, device.line.take());
  CHECK(device.client.configured());
}

TEST(an_answer_waits_until_the_line_has_room_for_all_of_it) {
  Device device;
  device.line.free = 186;
  device.receive(TOPIC_REQUEST, 1000);
  CHECK_EQUAL(0u, device.line.sent.size());
  CHECK(!device.client.configured());
  device.line.free = 187;
  device.client.spin(1001);
  CHECK_EQUAL(NEGOTIATION, device.line.take());
  CHECK(device.client.configured());
}

TEST(requests_while_the_line_is_busy_get_one_answer) {
  Device device;
  device.line.free = 0;
  for (uint32_t now = 1000; now < 1010; ++now) device.receive(TOPIC_REQUEST, now);
  device.line.free = 255;
  device.client.spin(1010);
  device.client.spin(1011);
  CHECK_EQUAL(NEGOTIATION, device.line.take());
}

TEST(a_command_reaches_the_handler) {
  Device device;
  device.receive(FORWARD, 1000);
  CHECK_EQUAL(1u, commands.size());
  CHECK_EQUAL(std::string("01 00 00"), commands.at(0));
}

TEST(messages_on_unknown_topics_are_ignored) {
  Device device;
  device.receive("ff fe 03 00 fc 65 00 01 00 00 99", 1000);
  device.receive("ff fe 00 00 ff 06 00 f9", 1000);
  CHECK(commands.empty());
  CHECK_EQUAL(std::string(""), device.line.take());
}

TEST(half_a_frame_is_forgotten_after_20_ms_of_silence) {
  Device device;
  device.receive("ff fe 10 00 ef 64 00 01", 1000);
  device.receive(FORWARD, 1021);
  CHECK_EQUAL(1u, commands.size());
}

TEST(a_frame_may_have_pauses_of_20_ms) {
  Device device;
  uint32_t now = UINT32_MAX - 50;  // the clock wraps on the way
  for (uint8_t byte : bytes(FORWARD)) device.client.receive(byte, now += 20);
  CHECK_EQUAL(1u, commands.size());
}

TEST(the_time_is_asked_every_2500_ms) {
  Device device;
  device.connect(1000);
  for (uint32_t now = 1000; now < 3500; ++now) device.client.spin(now);
  CHECK_EQUAL(std::string(""), device.line.take());
  device.client.spin(3500);
  CHECK_EQUAL(TIME_REQUEST, device.line.take());
  device.client.spin(5999);
  CHECK_EQUAL(std::string(""), device.line.take());
  device.client.spin(6000);
  CHECK_EQUAL(TIME_REQUEST, device.line.take());
}

TEST(a_time_request_waits_for_room) {
  Device device;
  device.connect(0);
  device.line.free = 15;
  device.client.spin(2500);
  CHECK_EQUAL(std::string(""), device.line.take());
  device.client.spin(2510);
  CHECK_EQUAL(TIME_REQUEST, device.line.take());
}

TEST(the_connection_is_given_up_11_s_after_the_last_time_answer) {
  Device device;
  const uint32_t start = UINT32_MAX - 5000;  // the clock wraps on the way
  device.connect(start);
  device.receive(TIME_ANSWER, start + 3000);
  device.client.spin(start + 14000);
  CHECK(device.client.configured());
  device.client.spin(start + 14001);
  CHECK(!device.client.configured());
  device.line.take();
  device.client.spin(start + 20000);
  CHECK_EQUAL(std::string(""), device.line.take());
}

TEST(commands_alone_do_not_keep_the_connection) {
  Device device;
  device.connect(0);
  for (uint32_t now = 0; now <= 11001; now += 25) device.receive(FORWARD, now);
  device.client.spin(11001);
  CHECK(!device.client.configured());
}

TEST(a_connection_that_was_given_up_comes_back_with_the_next_request) {
  Device device;
  device.connect(0);
  device.client.spin(11001);
  CHECK(!device.client.configured());
  device.line.take();
  device.receive(TOPIC_REQUEST, 20000);
  CHECK_EQUAL(NEGOTIATION, device.line.take());
  device.client.spin(22499);
  CHECK(device.client.configured());
}

TEST(tx_stop_silences_the_device_until_the_next_request) {
  Device device;
  device.connect(0);
  device.receive(TX_STOP, 100);
  CHECK(!device.client.configured());
  device.client.publish_empty();
  device.client.spin(5000);
  CHECK_EQUAL(std::string(""), device.line.take());
  device.receive(TOPIC_REQUEST, 6000);
  CHECK_EQUAL(NEGOTIATION, device.line.take());
}

TEST(a_hit_is_sent) {
  Device device;
  device.connect(0);
  device.client.publish_empty();
  device.client.spin(10);
  CHECK_EQUAL(HIT, device.line.take());
  device.client.spin(11);
  CHECK_EQUAL(std::string(""), device.line.take());
}

TEST(hits_wait_for_room_and_none_is_lost) {
  Device device;
  device.connect(0);
  device.line.free = 7;
  for (int i = 0; i < 3; ++i) device.client.publish_empty();
  device.client.spin(10);
  CHECK_EQUAL(0u, device.line.sent.size());
  device.line.free = 17;
  device.client.spin(11);
  CHECK_EQUAL(HIT + " " + HIT, device.line.take());
  device.client.spin(12);
  CHECK_EQUAL(HIT, device.line.take());
}

TEST(a_hit_without_a_connection_is_not_reported_later) {
  Device device;
  device.client.publish_empty();
  device.receive(TOPIC_REQUEST, 1000);
  CHECK_EQUAL(NEGOTIATION, device.line.take());
}

TEST(a_hit_that_waits_when_the_connection_ends_is_not_reported_later) {
  Device device;
  device.connect(0);
  device.line.free = 0;
  device.client.publish_empty();
  device.receive(TX_STOP, 100);
  device.line.free = 255;
  device.receive(TOPIC_REQUEST, 200);
  CHECK_EQUAL(NEGOTIATION, device.line.take());
}

TEST(a_hit_during_a_repeated_negotiation_follows_its_frames) {
  Device device;
  device.connect(0);
  device.line.free = 3;
  device.receive(TOPIC_REQUEST, 100);
  device.client.publish_empty();
  device.line.free = 255;
  device.client.spin(101);
  CHECK_EQUAL(NEGOTIATION + " " + HIT, device.line.take());
}

TEST(robot_msg_fields_are_signed_bytes_and_a_bool) {
  const RobotMsg command = decode_robot_msg(bytes("ff 01 01").data());
  CHECK_EQUAL(-1, command.linear_x);
  CHECK_EQUAL(1, command.angular_z);
  CHECK(command.shoot);
  CHECK(!decode_robot_msg(bytes("00 00 00").data()).shoot);
}
