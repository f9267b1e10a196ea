#include "arena_socket.h"

#include <errno.h>
#include <netdb.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

enum { CONNECT_TIMEOUT_MS = 2000 };

static void set_options(int connected)
{
	const int on = 1, idle_s = 5, interval_s = 2, probes = 3, unanswered_ms = 10000;

	setsockopt(connected, IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
	setsockopt(connected, SOL_SOCKET, SO_KEEPALIVE, &on, sizeof on);
	setsockopt(connected, IPPROTO_TCP, TCP_KEEPIDLE, &idle_s, sizeof idle_s);
	setsockopt(connected, IPPROTO_TCP, TCP_KEEPINTVL, &interval_s, sizeof interval_s);
	setsockopt(connected, IPPROTO_TCP, TCP_KEEPCNT, &probes, sizeof probes);
	setsockopt(connected, IPPROTO_TCP, TCP_USER_TIMEOUT, &unanswered_ms, sizeof unanswered_ms);
}

/* 0, or the errno of the failure. */
static int finish_connecting(int connecting)
{
	struct pollfd done = {.fd = connecting, .events = POLLOUT};
	int fault = 0;
	socklen_t length = sizeof fault;

	const int events = poll(&done, 1, CONNECT_TIMEOUT_MS);
	if (events == 0)
		return ETIMEDOUT;
	if (events < 0 || getsockopt(connecting, SOL_SOCKET, SO_ERROR, &fault, &length) != 0)
		return errno;
	return fault;
}

static int try_candidate(const struct addrinfo *candidate)
{
	const int fresh =
		socket(candidate->ai_family, candidate->ai_socktype | SOCK_NONBLOCK | SOCK_CLOEXEC, candidate->ai_protocol);
	int fault = 0;

	if (fresh < 0)
		return -1;
	if (connect(fresh, candidate->ai_addr, candidate->ai_addrlen) != 0)
		fault = errno == EINPROGRESS ? finish_connecting(fresh) : errno;
	if (fault == 0) {
		set_options(fresh);
		return fresh;
	}
	close(fresh);
	errno = fault;
	return -1;
}

int arena_socket_connect(const struct address *arena, const char **fault)
{
	const struct addrinfo wanted = {.ai_socktype = SOCK_STREAM, .ai_flags = AI_NUMERICSERV};
	struct addrinfo *found = NULL;
	int connected = -1;

	const int lookup = getaddrinfo(arena->host, arena->port, &wanted, &found);
	if (lookup != 0) {
		*fault = gai_strerror(lookup);
		return -1;
	}
	for (const struct addrinfo *next = found; next && connected < 0; next = next->ai_next)
		connected = try_candidate(next);
	if (connected < 0)
		*fault = strerror(errno);
	freeaddrinfo(found);
	return connected;
}
