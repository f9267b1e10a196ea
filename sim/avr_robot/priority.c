#include "priority.h"

#include <sched.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/resource.h>

#define LONGEST_TURN 500000 /* us of work without a pause */

static void give_back(int signal_number)
{
	(void)signal_number;
	sched_setscheduler(0, SCHED_OTHER, &(struct sched_param){0});
}

void priority_take(void)
{
	const char *wanted = getenv("LASERBOT_PRIORITY");
	const int priority = wanted && *wanted ? atoi(wanted) : 1;
	struct rlimit turn;

	if (priority <= 0 || getrlimit(RLIMIT_RTTIME, &turn) != 0)
		return;
	/* the kernel sends the signal to the thread that has worked for too long */
	sigaction(SIGXCPU, &(struct sigaction){.sa_handler = give_back, .sa_flags = SA_RESTART}, NULL);
	if (turn.rlim_max > LONGEST_TURN)
		turn.rlim_cur = LONGEST_TURN;
	setrlimit(RLIMIT_RTTIME, &turn);
	if (sched_setscheduler(0, SCHED_RR, &(struct sched_param){.sched_priority = priority}) == 0)
		fprintf(stderr, "avr_robot: runs at real-time priority %d\n", priority);
}
