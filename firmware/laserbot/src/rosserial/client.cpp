#include "client.h"

#include <string.h>

#include "../flash.h"
#include "port.h"

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

// So many questions are asked in TIME_ANSWER_MS. The clock alone does not end a connection: one wrong bit in it would.
constexpr uint8_t UNANSWERED_MAX = 4;

// A host that does not know a topic's type asks for the topics again when a message comes on it (upstream's
// rosserial_python). After the second time that topic is left out, so that the host's log and the line stay free.
constexpr uint32_t REFUSAL_MS = 200;
constexpr uint8_t REFUSALS = 2;

uint16_t topic_info_length(const Topic &topic) {
  return 2 + 4 + strlen_P(topic.name) + 4 + strlen_P(topic.type) + 4 + strlen_P(topic.md5) + 4;
}

bool has_room(size_t payload) { return port::room() >= FRAME_OVERHEAD + payload; }

}  // namespace

void Client::receive(uint8_t byte, const Now &now) {
  if (now.ms - last_byte_ > FRAME_SILENCE_MS) parser_.give_up();
  last_byte_ = now.ms;
  parser_.push(byte);
}

bool Client::message(const Now &now) {
  if (delivered_) parser_.pop();
  delivered_ = false;
  if (now.ms - last_byte_ > FRAME_SILENCE_MS) parser_.give_up();
  while (parser_.complete()) {
    if (parser_.topic() >= COMMAND) {
      delivered_ = true;
      return true;
    }
    handle(parser_.topic(), now);
    parser_.pop();
  }
  return false;
}

void Client::handle(uint16_t topic, const Now &now) {
  if (topic == ID_PUBLISHER) {
    topics_requested(now);
  } else if (topic == ID_TIME) {
    time_answered(now);
  } else if (topic == ID_TX_STOP) {
    disconnect();
  }
}

void Client::host_heard() {
  if (unasked_) configured_ = telling_ == NOTHING;
  unasked_ = false;
}

void Client::topics_requested(const Now &now) {
  host_heard();
  telling_ = 0;
  if (configured_ && now.ms - last_board_ < REFUSAL_MS && board_refused_ < REFUSALS) ++board_refused_;
}

void Client::time_answered(const Now &now) {
  host_heard();
  const uint32_t took = now.us - time_requested_us_;
  if (unanswered_ == 1) round_trip_ = took < UINT16_MAX ? took : UINT16_MAX;
  unanswered_ = 0;
  last_time_answer_ = now.ms;
}

void Client::spin(const Now &now) {
  if (configured_ && unanswered_ >= UNANSWERED_MAX && now.ms - last_time_answer_ > TIME_ANSWER_MS) disconnect();
  if (telling_ != NOTHING) tell(now);
  if (!configured_ || telling_ != NOTHING) return;
  if (now.ms - last_time_request_ >= TIME_REQUEST_MS) request_time(now);
  while (responses_ > 0 && has_room(0)) {
    FrameWriter(RESPONSE, 0).end();
    --responses_;
  }
  send_hits();
}

void Client::send_hits() {
  if (hits_waiting_ > HITS) hits_waiting_ = 0;  // never but for a disturbed RAM
  while (hits_waiting_ > 0 && has_room(HIT_LENGTH)) {
    FrameWriter frame(HIT, HIT_LENGTH);
    frame.u8(hits_[0].shooter);
    frame.u8(hits_[0].team);
    frame.u8(hits_[0].damage);
    frame.end();
    --hits_waiting_;
    memmove(hits_, hits_ + 1, hits_waiting_ * sizeof hits_[0]);
  }
}

void Client::publish_response() {
  if (configured_ && responses_ < UINT8_MAX) ++responses_;
}

void Client::publish_hit(const Hit &hit) {
  if (configured_ && hits_waiting_ < HITS) hits_[hits_waiting_++] = hit;
}

bool Client::publish_board(const BoardHealth &health, const Now &now) {
  if (!configured_ || telling_ != NOTHING || board_refused_ >= REFUSALS || !has_room(BOARD_HEALTH_LENGTH)) return false;
  FrameWriter frame(BOARD, BOARD_HEALTH_LENGTH);
  write(frame, health);
  frame.end();
  last_board_ = now.ms;
  return true;
}

void Client::disconnect() {
  telling_ = NOTHING;
  unasked_ = false;
  configured_ = false;
  responses_ = 0;
  hits_waiting_ = 0;
}

// The first part of the answer at once or, while the UART is busy, not yet: a question for the time and the two topics
// of the tech manual, as ever. The other topics follow one by one: all of them do not fit into the UART's buffer.
void Client::tell(const Now &now) {
  if (telling_ == 0) {
    const Topic first = topic_at(0), second = topic_at(1);
    const size_t answer = FRAME_OVERHEAD + TIME_LENGTH + FRAME_OVERHEAD + topic_info_length(first) + FRAME_OVERHEAD +
                          topic_info_length(second);
    if (port::room() < answer) return;
    unanswered_ = 0;
    last_time_answer_ = now.ms;
    request_time(now);
    send_topic_info(first);
    send_topic_info(second);
    telling_ = 2;
  }
  while (telling_ < TOPICS) {
    const Topic next = topic_at(telling_);
    if (!has_room(topic_info_length(next))) return;
    send_topic_info(next);
    ++telling_;
  }
  telling_ = NOTHING;
  configured_ = !unasked_;
}

void Client::request_time(const Now &now) {
  if (!has_room(TIME_LENGTH)) return;
  FrameWriter frame(ID_TIME, TIME_LENGTH);
  frame.u32(0);
  frame.u32(0);
  frame.end();
  last_time_request_ = now.ms;
  time_requested_us_ = now.us;
  if (unanswered_ < UINT8_MAX) ++unanswered_;
}

// rosserial_msgs/TopicInfo
void Client::send_topic_info(const Topic &topic) {
  FrameWriter frame(topic.published() ? ID_PUBLISHER : ID_SUBSCRIBER, topic_info_length(topic));
  frame.u16(topic.id);
  frame.string(topic.name);
  frame.string(topic.type);
  frame.string(topic.md5);
  frame.u32(ANNOUNCED_BUFFER);
  frame.end();
}

}  // namespace rosserial
