"""A whole Raspberry Pi 3 in QEMU, with a card in its slot, a network, and perhaps an Arduino at its USB. Or a
machine with nothing of a Pi but its processor, which is emulated twice as fast."""

import gzip
import json
import lzma
import os
import shutil
import subprocess
import tempfile
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import NamedTuple, Protocol

from tests.support.lan import Machine
from tests.support.polling import until
from tests.support.ports import free_port

FIRST_PARTITION = 8192 * 512  # bytes
MAC = "40:54:00:1a:5e:b0"  # at USB, QEMU has none that begins otherwise
SIZE = 4 << 30  # bytes of a card; QEMU asks for a power of two
START = 900.0  # s of a quiet machine until it can be logged in to; 145 were measured


def card_file(image: Path, name: str) -> bytes:
    """A file of a card's first partition."""
    return _mtools("mtype", image, f"::{name}")


def put_card_file(image: Path, name: str, content: bytes) -> None:
    _mtools("mcopy", image, "-o", "-", f"::{name}", content=content)


def new_card(image: Path, folder: Path, *settings: str) -> Path:
    """A card of one's own in that folder, with these lines in its laserbot.txt."""
    card = folder / "card.img"
    shutil.copy(image, card)
    write_settings(card, *settings)
    return card


def write_settings(card: Path, *settings: str) -> None:
    put_card_file(card, "laserbot.txt", "\r\n".join([*settings, ""]).encode())


def first_partition(image: Path) -> bytes:
    """The raw bytes of a card's first partition, those of deleted files too."""
    with image.open("rb") as card:
        card.seek(FIRST_PARTITION)
        return card.read(int(str(partitions(image)[0]["size"])) * 512)


def _mtools(program: str, image: Path, *arguments: str, content: bytes = b"") -> bytes:
    command = [program, "-i", f"{image}@@{FIRST_PARTITION}", *arguments]
    return subprocess.run(command, input=content, stdout=subprocess.PIPE, check=True).stdout


def _with_driver(image: Path, driver: str) -> bytes:
    """A card's initramfs, and behind it an archive with one more driver: the kernel lays one over the other."""
    initrd, name = card_file(image, "initrd"), Path(driver).name
    with tempfile.TemporaryDirectory() as folder:
        modules = Path(folder, "modules")
        modules.mkdir()
        read = ["cpio", "--quiet", "--extract", "--to-stdout", "modules/order"]
        order = subprocess.run(read, input=gzip.decompress(initrd), stdout=subprocess.PIPE, check=True).stdout
        (modules / "order").write_bytes(order + f"{name}.ko\n".encode())
        packed = _unsquashfs(image, "-cat", f"usr/lib/modules/*/kernel/drivers/{driver}.ko.xz")
        (modules / f"{name}.ko").write_bytes(lzma.decompress(packed))
        write = ["cpio", "--quiet", "--create", "--format=newc"]
        names = f"modules\nmodules/order\nmodules/{name}.ko\n".encode()
        archive = subprocess.run(write, input=names, cwd=folder, stdout=subprocess.PIPE, check=True).stdout
    return initrd + gzip.compress(archive)


class Network(Protocol):
    """What the Pi's network card is joined to."""

    netdev: str  # for QEMU
    target: list[str]  # for ssh

    def command(self, *words: str | Path) -> list[str]:
        """The command that runs `words` where that network is."""


class Port:
    """No network but a port of this machine, for SSH."""

    def __init__(self) -> None:
        port = free_port()
        self.netdev = f"user,restrict=on,hostfwd=tcp:127.0.0.1:{port}-:22"
        self.target = ["-p", str(port), "pi@127.0.0.1"]

    def command(self, *words: str | Path) -> list[str]:
        return list(map(str, words))


class Cable:
    """The network of a machine of a LAN, which becomes a mere switch. The Pi gets no address from anybody."""

    def __init__(self, machine: Machine) -> None:
        self._machine = machine
        self.netdev = "tap,ifname=port,script=no,downscript=no"
        # what every host makes of its network card's own address
        self.target = ["pi@fe80::4254:ff:fe1a:5eb0%switch"]
        machine.ip("addr", "flush", "dev", "eth0", "scope", "global")
        machine.ip("link", "add", "switch", "type", "bridge", "mcast_snooping", "0")
        machine.ip("tuntap", "add", "dev", "port", "mode", "tap")
        for port in ("eth0", "port"):
            machine.ip("link", "set", port, "master", "switch", "up")
        machine.ip("link", "set", "switch", "up")

    def command(self, *words: str | Path) -> list[str]:
        return self._machine.command(*words)


def arduino(port: int) -> list[str]:
    """QEMU's words for an Arduino at the Pi's USB, whose serial port is that TCP port where the Pi's network is."""
    chardev = f"socket,id=arduino,host=127.0.0.1,port={port},reconnect=1"
    return ["-chardev", chardev, "-device", "usb-serial,chardev=arduino"]


class Board(NamedTuple):
    """What QEMU emulates."""

    machine: tuple[str, ...]
    card: tuple[str, ...]  # {} is its file
    network_card: str
    settings: str = ""  # for the kernel
    tree: str = ""  # the file on the card that describes it to the kernel
    driver: str = ""  # of its disk, if the card's initramfs has none
    usb: tuple[str, ...] = ()  # a USB controller, if the machine has none


PI_3 = Board(
    ("-M", "raspi3b", "-m", "1G"),
    ("-drive", "if=sd,format=raw,file={}"),
    "usb-net",
    # QEMU's watchdog resets the Pi as soon as it is started; its network card is busy while a wrong driver tries it
    "systemd.watchdog_sec=off modprobe.blacklist=cdc_subset",
    "bcm2837-rpi-3-b.dtb",
)
STAND_IN = Board(
    # with more processors than there are, they wait for one another
    (
        *("-M", "virt", "-cpu", "cortex-a53", "-smp", str(min(4, len(os.sched_getaffinity(0)))), "-m", "2G"),
        *("-rtc", "base=2020-01-01"),  # a Pi has no clock that would know better
    ),
    ("-drive", "if=none,id=card,format=raw,file={}", "-device", "virtio-blk-pci,drive=card"),
    "virtio-net-pci",
    driver="block/virtio_blk",
    usb=("-device", "qemu-xhci"),
)


class RaspberryPi:
    """One that can be switched on and off as often as one likes. It keeps what it writes to its card."""

    def __init__(
        self,
        folder: Path,
        card: Path,
        key: Path,
        network: Network | None = None,
        *,
        usb: Sequence[str] = (),
        board: Board = PI_3,
    ) -> None:
        """`card`: an image of its own, which grows to SIZE. `key`: the private SSH key that opens it. `usb`: QEMU's
        words for what is plugged in."""
        self._folder = folder
        self._key = key
        # raw, as what was written to another format may be lost when the emulator is killed
        self._card = card
        os.truncate(card, SIZE)
        # what the Pi's own firmware would load
        (folder / "vmlinuz").write_bytes(card_file(card, "vmlinuz"))
        initrd = _with_driver(card, board.driver) if board.driver else card_file(card, "initrd")
        (folder / "initrd").write_bytes(initrd)
        self._boot = ["-kernel", str(folder / "vmlinuz"), "-initrd", str(folder / "initrd")]
        if board.tree:
            (folder / board.tree).write_bytes(card_file(card, board.tree))
            self._boot += ["-dtb", str(folder / board.tree)]
        self._words = card_file(card, "cmdline.txt").decode().strip()
        self._network = network or Port()
        self._screen = folder / "serial.log"
        self._usb = usb
        self._board = board

    @contextmanager
    def on(self) -> Iterator[None]:
        """Until the plug is pulled, at the end."""
        board = self._board
        words = ["-append", f"{self._words} console=ttyAMA0,115200 {board.settings}"]
        disk = [word.format(self._card) for word in board.card]
        network_card = f"{board.network_card},netdev=lan,mac={MAC}"
        lan = ["-netdev", f"{self._network.netdev},id=lan", "-device", network_card]
        screen = ["-display", "none", "-serial", f"file:{self._screen}", "-monitor", "none"]
        machine = ["qemu-system-aarch64", *board.machine, "-no-reboot"]
        command = self._network.command(*machine, *self._boot, *words, *disk, *lan, *board.usb, *self._usb, *screen)
        self._pi = subprocess.Popen(command, stdin=subprocess.DEVNULL)
        try:
            yield
        finally:
            self._pi.kill()
            self._pi.wait()

    def screen(self) -> str:
        """What it has said since it was last switched on."""
        return self._screen.read_text(errors="replace") if self._screen.exists() else ""

    def run(self, command: str) -> str:
        """What a command of the user pi prints, as soon as the Pi lets one log in. AssertionError if it fails."""

        def attempt() -> subprocess.CompletedProcess[str] | None:
            assert self._pi.poll() is None, "the Raspberry Pi has switched itself off"
            result = self._ssh(command)
            return None if result.returncode == 255 else result  # 255 is ssh's own

        try:
            result = until(attempt, START, "the Raspberry Pi lets nobody log in")
        except AssertionError as error:
            error.add_note(self.screen()[-2000:])
            raise
        assert result.returncode == 0, result.stderr
        return result.stdout

    def _ssh(self, command: str) -> subprocess.CompletedProcess[str]:
        options = ["BatchMode=yes", "StrictHostKeyChecking=no", f"UserKnownHostsFile={self._folder / 'known_hosts'}"]
        options += ["ConnectTimeout=60", "LogLevel=ERROR"]
        words = [word for option in options for word in ("-o", option)]
        ssh = self._network.command("ssh", *words, "-i", self._key, *self._network.target, command)
        return subprocess.run(ssh, capture_output=True, text=True, check=False)


def system_file(image: Path, name: str) -> str:
    """A file of a card's second partition."""
    return _unsquashfs(image, "-cat", name).decode()


def system_folder(image: Path, name: str) -> list[str]:
    """The files in a folder of a card's second partition, by name."""
    listed = _unsquashfs(image, "-l", name).decode().splitlines()
    return sorted(line.rpartition("/")[2] for line in listed if f"/{name}/" in line)


def _unsquashfs(image: Path, how: str, name: str) -> bytes:
    start = int(str(partitions(image)[1]["start"])) * 512
    command = ["unsquashfs", "-o", str(start), how, str(image), name]
    return subprocess.run(command, stdout=subprocess.PIPE, check=True).stdout


def partitions(image: Path) -> list[dict[str, object]]:
    """Of a disk, as sfdisk lists them."""
    printed = subprocess.run(["sfdisk", "--json", str(image)], stdout=subprocess.PIPE, check=True).stdout
    return list(json.loads(printed)["partitiontable"]["partitions"])
