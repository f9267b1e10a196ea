"""The demo, opened to the network by LASERBOT_BIND."""

import re
import signal
import sys

import pytest

from tests.support.lan import Lan, needs_root
from tests.support.polling import until
from tests.support.ports import free_port
from tests.support.programs import ROOT

pytestmark = needs_root

EARS = "tests.integration.discovery.ears"
NODES = ["/robots_server", "/rosbridge_websocket", "/Robot0"]


@pytest.mark.slow
def test_others_reach_the_game(lan: Lan) -> None:
    """Its own virtual robots stay on the machine."""
    here, other = lan.machine(), lan.machine()
    port = str(free_port())  # which names the demo's folder
    variables = {"LASERBOT_BIND": "0.0.0.0", "LASERBOT_ARENA": "hall", "LASERBOT_WEB_PORT": port}
    demo = here.program(ROOT / "ci" / "demo", "--robots", "1", "--bots", "0", env=variables)
    try:
        output = demo.wait_for("Ctrl-C stops everything", 90)
        assert f"In this network the game is at\n  http://10.9.0.1:{port}\n" in output
        for page, answer in ((port, "200"), ("8080", "200"), ("9090", "426"), ("9091", "426")):  # two want a WebSocket
            url = f"http://10.9.0.1:{page}"
            assert other.run("curl", "-s", "-o", "/dev/null", "-w", "%{http_code}", url) == answer
        ears = other.python(EARS)
        assert '"hall": {"addresses": ["10.9.0.1"]' in ears.wait_for('"hall"')
        ears.kill()
        look_up = "ServerProxy('http://10.9.0.1:11311').lookupNode"
        code = f"from xmlrpc.client import *; print([{look_up}('/test', node) for node in {NODES}])"

        def hosts() -> list[str]:
            return re.findall(r"http://([^:]+):", other.run(sys.executable, "-c", code))

        until(lambda: len(hosts()) == len(NODES), 20, "the virtual robot's node")
        assert hosts() == ["10.9.0.1", "10.9.0.1", "127.0.0.1"]
    finally:
        assert demo.stop(signal.SIGINT, 30) == 0
