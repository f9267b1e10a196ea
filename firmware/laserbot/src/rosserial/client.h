// The device's side of the rosserial connection: negotiation of the topics, time sync, one published and one subscribed
// topic.
#pragma once

#include "frame.h"

namespace rosserial {

struct Topic {
  uint16_t id;  // subscribers from 100, publishers from 125, as ros_lib numbers them on an ATmega328P
  const char *name;
  const char *type;
  const char *md5;
};

// Called with the payload of each message on the subscribed topic, whether the topics have been negotiated or not:
// after a reset in mid-battle the robot obeys again at once, as with ros_lib.
typedef void (*Handler)(const uint8_t *payload, uint16_t length);

class Client {
 public:
  Client(Port &port, const Topic &published, const Topic &subscribed, Handler handler)
      : port_(port), published_(published), subscribed_(subscribed), handler_(handler) {}

  // Takes one byte from the host; `now` in ms, may wrap.
  void receive(uint8_t byte, uint32_t now);

  // Does what is due: answers a topic request, asks for the time, sends waiting messages. Never waits for the UART.
  void spin(uint32_t now);

  // Publishes one std_msgs/Empty. It waits for room in the UART if need be. Without a host that knows the topic it is
  // dropped: a hit from before the connection came up would count in a battle that it does not belong to.
  void publish_empty();

  // Whether the host has asked for the topics and still answers.
  bool configured() const { return configured_; }

 private:
  void handle(uint16_t topic, uint32_t now);
  void disconnect();
  void negotiate(uint32_t now);
  void request_time(uint32_t now);
  void send_topic_info(uint16_t kind, const Topic &topic);

  Port &port_;
  const Topic published_;
  const Topic subscribed_;
  const Handler handler_;

  FrameParser parser_;
  uint32_t last_byte_ = 0;
  uint32_t last_time_request_ = 0;
  uint32_t last_time_answer_ = 0;
  bool topics_requested_ = false;
  bool configured_ = false;
  uint8_t unsent_ = 0;
};

}  // namespace rosserial
