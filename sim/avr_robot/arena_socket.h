/* Connecting to the arena; may wait for some seconds. */
#ifndef AVR_ROBOT_ARENA_SOCKET_H
#define AVR_ROBOT_ARENA_SOCKET_H

#include "options.h"

/* A connected socket (TCP_NODELAY, notices a vanished arena after about 10 s), or -1 with the reason in `fault`. */
int arena_socket_connect(const struct address *arena, const char **fault);

#endif
