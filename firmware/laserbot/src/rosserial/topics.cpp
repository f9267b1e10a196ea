#include "topics.h"

#include "../flash.h"

namespace rosserial {

namespace {

const char RESPONSE_NAME[] PROGMEM = "response";
const char COMMAND_NAME[] PROGMEM = "command";
const char HIT_NAME[] PROGMEM = "hit";
const char BOARD_NAME[] PROGMEM = "board";
const char SETUP_NAME[] PROGMEM = "setup";
const char IDENTIFY_NAME[] PROGMEM = "identify";

const char EMPTY_TYPE[] PROGMEM = "std_msgs/Empty";
const char COMMAND_TYPE[] PROGMEM = "laser_bot_battle/Robot_msg";
const char HIT_TYPE[] PROGMEM = "laser_bot_battle/Hit";
const char BOARD_TYPE[] PROGMEM = "laser_bot_battle/BoardHealth";
const char SETUP_TYPE[] PROGMEM = "laser_bot_battle/Setup";

const char EMPTY_MD5[] PROGMEM = "d41d8cd98f00b204e9800998ecf8427e";
const char COMMAND_MD5[] PROGMEM = "aa81278360e1bdd1ffce0a4efe0ae199";
const char HIT_MD5[] PROGMEM = "a4c3133dcaff471ab13a4e3630be7448";
const char BOARD_MD5[] PROGMEM = "ce93022442a8a38cf094bba3a502a1a1";
const char SETUP_MD5[] PROGMEM = "da8bd946849f4662c7ec33b814c0165d";

const Topic TABLE[TOPICS] PROGMEM = {
    {RESPONSE, RESPONSE_NAME, EMPTY_TYPE, EMPTY_MD5},
    {COMMAND, COMMAND_NAME, COMMAND_TYPE, COMMAND_MD5},
    {HIT, HIT_NAME, HIT_TYPE, HIT_MD5},
    {BOARD, BOARD_NAME, BOARD_TYPE, BOARD_MD5},
    {SETUP, SETUP_NAME, SETUP_TYPE, SETUP_MD5},
    {IDENTIFY, IDENTIFY_NAME, EMPTY_TYPE, EMPTY_MD5},
};

}  // namespace

Topic topic_at(uint8_t index) {
  Topic topic;
  memcpy_P(&topic, &TABLE[index], sizeof topic);
  return topic;
}

}  // namespace rosserial
