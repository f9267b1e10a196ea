"""For all tests."""

import signal

# A shell starts background programs with SIGINT ignored, and so would be what the tests start and stop by SIGINT.
signal.signal(signal.SIGINT, signal.default_int_handler)
