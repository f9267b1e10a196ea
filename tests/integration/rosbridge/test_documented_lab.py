"""The page on rosbridge for any ROS 1 system is true."""

import sys

from tests.integration.rosbridge.documented import Lab, lab
from tests.support.programs import Program

__all__ = ["lab"]


def test_the_python_example_runs(lab: Lab) -> None:
    example = Program([sys.executable, "-c", lab.example("python")])
    try:
        assert example.exit_code(30) == 0, example.output
    finally:
        example.kill()
    assert "'/game_status'" in example.output
