// The UART to the Raspberry Pi. The core's Serial has room for 63 bytes to send and waits when they are used up; an
// answer to a topic request has 187. This one has room for 255 and never waits, so the loop always runs on.
#pragma once

#include "../rosserial/frame.h"

class Uart : public rosserial::Port {
 public:
  void begin();
  size_t room() const override;
  void write(uint8_t byte) override;
  // Whether there is a byte; takes it.
  bool read(uint8_t &byte);
};
