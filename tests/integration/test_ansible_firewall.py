"""roles/firewall: what the master's rules let in, between machines of a LAN."""

import sys
from pathlib import Path

import jinja2
import yaml

from tests.support.lan import Lan, Machine, needs_root
from tests.support.programs import ROOT

ROLES = ROOT / "ansible" / "roles"
PORT, MOST = 5000, 400

SERVER = f"""
import signal, socket
listeners = [socket.create_server(("0.0.0.0", {PORT}), backlog=1000)]
listeners.append(socket.create_server(("::", {PORT}), family=socket.AF_INET6, backlog=1000))
print("listening", flush=True)
signal.pause()  # until the test ends it
"""
VISITOR = f"""
import socket, sys
taken = []
try:
    for _ in range({MOST + 50}):
        taken.append(socket.create_connection((sys.argv[1], {PORT}), 5))
except ConnectionRefusedError:
    pass
print(len(taken))
"""


def rules(machine: Machine, folder: Path) -> None:
    """Of a master whose fleet is somewhere else."""
    known = yaml.safe_load((ROLES / "fleet/vars/main.yml").read_text())
    own = yaml.safe_load((ROLES / "firewall/defaults/main.yml").read_text())
    own.update(
        group_names=["master"], firewall_fleet=["192.0.2.1"], fleet_players_ports=[PORT], ansible_managed="a test"
    )
    own.update(fleet_control_networks=["192.0.2.0/24"])
    template = jinja2.Template((ROLES / "firewall/templates/firewall.nft.j2").read_text(), trim_blocks=True)
    (folder / "firewall.nft").write_text(template.render({**known, **own}))
    machine.run("nft", "--file", folder / "firewall.nft")


@needs_root
def test_one_visitor_has_so_many_connections_by_either_family(tmp_path: Path) -> None:
    with Lan() as lan:
        master, visitor = lan.machine(), lan.machine()
        for number, machine in enumerate((master, visitor), 1):
            machine.ip("addr", "add", f"fd00:9::{number}/64", "dev", "eth0", "nodad")
        rules(master, tmp_path)
        server = master.program(sys.executable, "-c", SERVER)
        try:
            server.wait_for("listening")
            for address in ("10.9.0.1", "fd00:9::1"):
                assert visitor.run(sys.executable, "-c", VISITOR, address) == f"{MOST}\n", address
        finally:
            server.kill()
