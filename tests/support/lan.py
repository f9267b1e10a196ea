"""A LAN of its own: machines that are network namespaces, joined by a switch, with real multicast. Needs root.

Nothing of it outlives the program that made it: a namespace ends with its processes.
"""

import contextlib
import os
import subprocess
import sys
from collections.abc import Iterator, Mapping
from pathlib import Path

import pytest

from tests.support.polling import until
from tests.support.programs import ROOT, Program

NETWORK = "10.9.0"

needs_root = pytest.mark.skipif(os.geteuid() != 0, reason="only root can make networks")


class Machine:
    """A network namespace, and a mount namespace with a /run of its own; eth0 leads to the switch."""

    def __init__(self) -> None:
        hold = "mount -t tmpfs tmpfs /run && echo up && exec sleep inf"
        self._holder = Program(["unshare", "--net", "--mount", "sh", "-c", hold])
        self._holder.wait_for("up\n")
        self.ip("link", "set", "lo", "up")

    def __enter__(self) -> "Machine":
        return self

    def __exit__(self, *_: object) -> None:
        self._holder.kill()

    @property
    def pid(self) -> int:
        """Of a process within."""
        return self._holder.process.pid

    def command(self, *words: str | Path) -> list[str]:
        """The command that runs `words` on this machine."""
        # its root, too: within a chroot, a mount namespace alone would lead out of that
        return ["nsenter", f"--target={self.pid}", "--net", "--mount", "--root", "--wd", *map(str, words)]

    def run(self, *words: str | Path) -> str:
        """The output of a command on this machine; CalledProcessError when it fails."""
        result = subprocess.run(self.command(*words), capture_output=True, text=True, check=False, timeout=30)
        assert result.returncode == 0, f"{words}: {result.stderr}"
        return result.stdout

    def ip(self, *words: str) -> None:
        self.run("ip", *words)

    def program(self, *words: str | Path, env: Mapping[str, str] | None = None) -> Program:
        return Program(self.command(*words), env)

    def python(self, module: str, *arguments: str, env: Mapping[str, str] | None = None) -> Program:
        """The Python module `module` of this repository, on this machine."""
        path = f"{ROOT}:{ROOT / 'build/python'}"
        return self.program(sys.executable, "-m", module, *arguments, env={"PYTHONPATH": path, **(env or {})})

    def set_address(self, number: int) -> None:
        """Make 10.9.0.`number` its only address, and the way to all other networks."""
        self.ip("addr", "flush", "dev", "eth0", "scope", "global")
        self.ip("addr", "add", f"{NETWORK}.{number}/24", "dev", "eth0")
        self.ip("route", "replace", "default", "via", f"{NETWORK}.254")


class Lan:
    """The switch. Machines get the addresses 10.9.0.1, 10.9.0.2 and so on."""

    def __init__(self) -> None:
        self._stack = contextlib.ExitStack()
        self._switch = self._stack.enter_context(Machine())
        self._machines: list[Machine] = []
        # without snooping: there is no querier, and groups would be forgotten
        self._switch.ip("link", "add", "switch", "type", "bridge", "mcast_snooping", "0")
        self._switch.ip("link", "set", "switch", "up")

    def __enter__(self) -> "Lan":
        return self

    def __exit__(self, *_: object) -> None:
        self._stack.close()

    def machine(self) -> Machine:
        """A new machine, on the switch."""
        machine = self._stack.enter_context(Machine())
        self._machines.append(machine)
        number = len(self._machines)
        port = f"port{number}"
        self._switch.ip("link", "add", port, "type", "veth", "peer", "name", "eth0", "netns", str(machine.pid))
        self._switch.ip("link", "set", port, "master", "switch", "up")
        machine.ip("link", "set", "eth0", "up")
        machine.set_address(number)
        return machine

    def plug(self, machine: Machine, plugged: bool = True) -> None:
        """Put the machine's cable into the switch, or pull it out."""
        number = self._machines.index(machine) + 1
        self._switch.ip("link", "set", f"port{number}", "up" if plugged else "down")

    def stop_multicast(self) -> None:
        """No multicast passes the switch any more, as in the networks of containers and pods."""
        for number, _ in enumerate(self._machines, 1):
            self._switch.ip("link", "set", f"port{number}", "type", "bridge_slave", "mcast_flood", "off")


@contextlib.contextmanager
def avahi(machine: Machine, folder: Path, host_name: str) -> Iterator[Program]:
    """The avahi daemon on a machine: `host_name`.local, and what avahi-resolve and avahi-browse ask for."""
    settings = folder / f"avahi-{host_name}.conf"
    settings.write_text(f"[server]\nhost-name={host_name}\n[publish]\npublish-workstation=no\n")
    with system_bus(machine, folder):
        daemon = machine.program("avahi-daemon", "--no-drop-root", "--no-chroot", "--no-rlimits", "-f", settings)
        try:
            daemon.wait_for("Server startup complete")
            yield daemon
        finally:
            daemon.kill()


@contextlib.contextmanager
def system_bus(machine: Machine, folder: Path) -> Iterator[None]:
    """D-Bus on a machine, on which everybody may do everything."""
    machine.run("mkdir", "-p", "/run/dbus", "/run/avahi-daemon")
    machine.run("rm", "-f", "/run/dbus/system_bus_socket")
    settings = folder / "bus.conf"
    settings.write_text(
        '<!DOCTYPE busconfig PUBLIC "-//freedesktop//DTD D-Bus Bus Configuration 1.0//EN"'
        ' "http://www.freedesktop.org/standards/dbus/1.0/busconfig.dtd">'
        "<busconfig><type>system</type><listen>unix:path=/run/dbus/system_bus_socket</listen><auth>EXTERNAL</auth>"
        '<policy context="default"><allow user="*"/><allow own="*"/><allow send_destination="*"/>'
        '<allow receive_sender="*"/></policy></busconfig>'
    )
    daemon = machine.program("dbus-daemon", "--nofork", "--print-address", f"--config-file={settings}")
    try:
        daemon.wait_for("unix:path=")
        yield
    finally:
        daemon.kill()


def sees(machine: Machine, other: str) -> None:
    """Wait until the machine reaches the address `other`."""

    def reached() -> bool:
        knock = machine.command("timeout", "1", "bash", "-c", f"exec 3<>/dev/tcp/{other}/9")
        return b"refused" in subprocess.run(knock, capture_output=True, check=False).stderr

    until(reached, 10, f"{other} answers")
