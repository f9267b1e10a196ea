#include "trace.h"

#include <inttypes.h>
#include <stdarg.h>
#include <time.h>

void trace_event(struct trace *trace, uint64_t cycles, const char *format, ...)
{
	if (!trace->out)
		return;

	struct timespec now;
	clock_gettime(CLOCK_MONOTONIC, &now);
	fprintf(trace->out, "%" PRIu64 " %" PRIu64 " ", (uint64_t)now.tv_sec * 1000000000u + (uint64_t)now.tv_nsec, cycles);

	va_list words;
	va_start(words, format);
	vfprintf(trace->out, format, words);
	va_end(words);
	fputc('\n', trace->out);
	trace->dirty = true;
}

void trace_flush(struct trace *trace)
{
	if (!trace->dirty)
		return;
	trace->dirty = false;
	if (fflush(trace->out) != 0)
		trace->out = NULL; /* whoever read the trace has gone; the robot drives on */
}
