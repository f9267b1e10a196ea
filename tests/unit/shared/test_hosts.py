"""What may stand in the header Host, and how a policy has it."""

import os
import subprocess
import sys

import pytest

from laser_bot_battle.hosts import is_valid_host, policy_source


@pytest.mark.parametrize(
    "host",
    [
        "laser_bot_master.local",
        "laser_bot_master.local:5000",
        "localhost",
        "127.0.0.1:1",
        "[::1]",
        "[fe80::1]:65535",
        "a.",
        "x" * 63,
        "xn--caf-dma.example",
    ],
)
def test_names_and_addresses(host: str) -> None:
    assert is_valid_host(host)


@pytest.mark.parametrize(
    "host",
    ["", " ", ".", "-a", "a:", "a:b", "a..b", "a b", "a/b", "a@b", "a,b", "a\n", "%00", "::1", "[::1", "[zz]", "xn--a"],
)
def test_anything_else_is_none(host: str) -> None:
    assert not is_valid_host(host)


@pytest.mark.parametrize(
    "host", ["*", "*.local", "a;b *", "x" * 64, ".".join(["x" * 60] * 5), "a:99999999", "\xe9", "\u0661"]
)
def test_what_is_too_long_or_has_other_characters_is_none(host: str) -> None:
    assert not is_valid_host(host)


@pytest.mark.parametrize(
    ("host", "source"),
    [
        ("hall.local:8080", ("hall.local", ":8080")),
        ("10.0.0.9", ("10.0.0.9", "")),
        ("laser_bot_master.local:80", ("*", ":80")),  # browsers pass over such names in a policy
        ("[::1]", ("*", "")),
    ],
)
def test_a_policy_has_the_name_where_it_can(host: str, source: tuple[str, str]) -> None:
    assert policy_source(host) == source


def test_a_policy_takes_nothing_that_is_no_host() -> None:
    with pytest.raises(ValueError, match="no host"):
        policy_source("a; script-src *")


WITHOUT_FILES = """
import resource
from laser_bot_battle.hosts import is_valid_host
from laser_bot_battle.log import visible
resource.setrlimit(resource.RLIMIT_NOFILE, (0, 0))
print(is_valid_host("localhost:8080"), visible("\a"))
"""


def test_a_host_is_read_and_a_line_is_logged_when_files_have_run_out() -> None:
    """Although nothing has needed their codecs before."""
    command, environment = [sys.executable, "-c", WITHOUT_FILES], {"PYTHONPATH": os.pathsep.join(sys.path)}
    result = subprocess.run(command, env=environment, capture_output=True, text=True, check=False)
    assert (result.stdout, result.stderr) == ("True \\x07\n", "")
