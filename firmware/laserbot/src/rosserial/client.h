// The device's side of the rosserial connection: negotiation of the topics, time sync, messages both ways.
#pragma once

#include "../board_health_msg.h"
#include "../hit_msg.h"
#include "frame.h"
#include "topics.h"

namespace rosserial {

// A moment; both clocks may wrap.
struct Now {
  Now(uint32_t ms, uint32_t us) : ms(ms), us(us) {}
  Now(uint32_t ms) : ms(ms), us(ms * 1000) {}  // for those who need no more
  uint32_t ms;
  uint32_t us;
};

class Client {
 public:
  // Takes one byte from the host; message() has to be called until it is false before the next byte.
  void receive(uint8_t byte, const Now &now);

  // Whether a message of the host is at hand, each time the next one: topic(), payload() and length() describe it. They
  // come whether the topics have been negotiated or not: after a reset in mid-battle the robot obeys again at once, as
  // with ros_lib.
  bool message(const Now &now);
  uint16_t topic() const { return parser_.topic(); }
  const uint8_t *payload() const { return parser_.payload(); }
  uint16_t length() const { return parser_.length(); }

  // Does what is due: answers a topic request, asks for the time, sends waiting messages. Never waits for the UART.
  void spin(const Now &now);

  // Tells the topics though nobody has asked: a host may not know that the device has started again. Whether there is
  // one is known when it answers the question for the time.
  void announce() {
    telling_ = 0;
    unasked_ = true;
  }

  // Publishes on `response` and `hit`. A message waits for room in the UART if need be. Without a host that knows the
  // topics it is dropped: a hit from before the connection came up would count in a battle that it does not belong to.
  void publish_response();
  void publish_hit(const Hit &hit);

  // Publishes on `board`, if the host knows the topic and there is room; returns whether.
  bool publish_board(const BoardHealth &health, const Now &now);

  // Whether the host knows the topics and still answers.
  bool configured() const { return configured_; }

  // us from the last question for the time to its answer; 0: none yet.
  uint16_t round_trip() const { return round_trip_; }

  const FrameParser &parser() const { return parser_; }

 private:
  void handle(uint16_t topic, const Now &now);
  void topics_requested(const Now &now);
  void time_answered(const Now &now);
  void host_heard();
  void disconnect();
  void tell(const Now &now);
  void request_time(const Now &now);
  void send_topic_info(const Topic &topic);
  void send_hits();

  static constexpr uint8_t NOTHING = 0xff;
  static constexpr uint8_t HITS = 8;  // more cannot come in the 0.1 s that an answer to a topic request takes

  FrameParser parser_;
  bool delivered_ = false;  // the frame at hand has been given to the program
  uint32_t last_byte_ = 0;
  uint32_t last_time_request_ = 0;
  uint32_t time_requested_us_ = 0;
  uint32_t last_time_answer_ = 0;
  uint32_t last_board_ = 0;
  uint16_t round_trip_ = 0;
  uint8_t unanswered_ = 0;     // questions for the time
  uint8_t board_refused_ = 0;  // times that the host asked for the topics right after a message on `board`
  uint8_t telling_ = NOTHING;  // index of the topic that is told next
  bool unasked_ = false;       // the topics are or were told so, and no host has been heard since
  bool configured_ = false;
  uint8_t responses_ = 0;
  uint8_t hits_waiting_ = 0;
  Hit hits_[HITS];
};

}  // namespace rosserial
