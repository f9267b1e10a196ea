#include "client.h"

#include <string.h>

namespace rosserial {

namespace {

constexpr uint16_t ID_PUBLISHER = 0;  // from the host: request for the topics
constexpr uint16_t ID_SUBSCRIBER = 1;
constexpr uint16_t ID_TIME = 10;
constexpr uint16_t ID_TX_STOP = 11;

constexpr uint16_t TIME_LENGTH = 8;

// Announced, not allocated: what ros_lib announces on this chip, so that hosts treat this device as one of its kind.
constexpr uint32_t ANNOUNCED_BUFFER = 280;

constexpr uint32_t FRAME_SILENCE_MS = 20;
constexpr uint32_t TIME_REQUEST_MS = 2500;
constexpr uint32_t TIME_ANSWER_MS = 11000;

uint16_t topic_info_length(const Topic &topic) {
  return 2 + 4 + strlen(topic.name) + 4 + strlen(topic.type) + 4 + strlen(topic.md5) + 4;
}

}  // namespace

void Client::receive(uint8_t byte, uint32_t now) {
  if (now - last_byte_ > FRAME_SILENCE_MS) parser_.reset();
  last_byte_ = now;
  parser_.push(byte);
  while (parser_.complete()) {
    handle(parser_.topic(), now);
    parser_.pop();
  }
}

void Client::handle(uint16_t topic, uint32_t now) {
  if (topic == ID_PUBLISHER) {
    topics_requested_ = true;
  } else if (topic == ID_TIME) {
    last_time_answer_ = now;
  } else if (topic == ID_TX_STOP) {
    disconnect();
  } else if (topic == subscribed_.id) {
    handler_(parser_.payload(), parser_.length());
  }
}

void Client::spin(uint32_t now) {
  if (configured_ && now - last_time_answer_ > TIME_ANSWER_MS) disconnect();
  if (topics_requested_) negotiate(now);
  if (!configured_) return;
  if (now - last_time_request_ >= TIME_REQUEST_MS) request_time(now);
  while (unsent_ > 0 && port_.room() >= FRAME_OVERHEAD) {
    FrameWriter(port_, published_.id, 0).end();
    --unsent_;
  }
}

void Client::publish_empty() {
  if (configured_ && unsent_ < UINT8_MAX) ++unsent_;
}

void Client::disconnect() {
  topics_requested_ = false;
  configured_ = false;
  unsent_ = 0;
}

// All frames of the answer at once or, while the UART is busy, none yet. More requests meanwhile get the same answer.
void Client::negotiate(uint32_t now) {
  const size_t answer = FRAME_OVERHEAD + TIME_LENGTH + FRAME_OVERHEAD + topic_info_length(published_) + FRAME_OVERHEAD +
                        topic_info_length(subscribed_);
  if (port_.room() < answer) return;
  request_time(now);
  send_topic_info(ID_PUBLISHER, published_);
  send_topic_info(ID_SUBSCRIBER, subscribed_);
  topics_requested_ = false;
  configured_ = true;
  last_time_answer_ = now;
}

void Client::request_time(uint32_t now) {
  if (port_.room() < FRAME_OVERHEAD + TIME_LENGTH) return;
  FrameWriter frame(port_, ID_TIME, TIME_LENGTH);
  frame.u32(0);
  frame.u32(0);
  frame.end();
  last_time_request_ = now;
}

// rosserial_msgs/TopicInfo
void Client::send_topic_info(uint16_t kind, const Topic &topic) {
  FrameWriter frame(port_, kind, topic_info_length(topic));
  frame.u16(topic.id);
  frame.string(topic.name);
  frame.string(topic.type);
  frame.string(topic.md5);
  frame.u32(ANNOUNCED_BUFFER);
  frame.end();
}

}  // namespace rosserial
