"""A system as it comes from the imager, and what a host has more or other than that."""

import re
from collections.abc import Callable

from fleet import Machine
from tests.support.containers import engine
from tests.support.rehearsal import outside

# What is different on each host, or is left by Debian's packages when they are purged: backups.
OWN = re.compile(
    r"/etc/(machine-id|ssh/ssh_host_.*|resolv\.conf|hosts|hostname|ld\.so\.cache|.*-|\.pwd\.lock|\.updated|mailcap|networks|.*/\.wh\..*)"
)


def card_of(machine: Machine) -> Callable[[str], str]:
    """Runs commands on a system as it comes from the imager; the machine's own was one."""
    image = outside(machine).attrs["Config"]["Image"]

    def run(command: str) -> str:
        return engine().containers.run(image, ["-c", command], entrypoint="sh", remove=True).decode()

    return run


def settings(run: Callable[[str], str]) -> dict[str, str]:
    """Checksum of each file below /etc, target of each link that is a setting."""
    lines = run("find /etc -xdev -type f -exec sha256sum {} +").splitlines()
    files = {path: checksum for checksum, path in (line.split(maxsplit=1) for line in lines) if not OWN.fullmatch(path)}
    return files | {"/etc/localtime": run("readlink /etc/localtime || true")}


def packages(run: Callable[[str], str]) -> set[str]:
    lines = run("dpkg-query --show --showformat '${Package} ${db:Status-Status}\\n'").splitlines()
    return {line.split()[0] for line in lines if not line.endswith("config-files")}
