"""For all tests."""

import os
import signal

# A shell starts background programs with SIGINT ignored, and so would be what the tests start and stop by SIGINT.
signal.signal(signal.SIGINT, signal.default_int_handler)

# On a machine with GPIO, the robots that the tests start would drive one of its lines.
os.environ["LASERBOT_LED"] = "none"
