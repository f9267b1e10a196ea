"""The units of a card fit together: what is enabled, wanted or run is there."""

import re
from pathlib import Path

from cards import follow
from cards.files import STATE
from cards.store import Store
from cards.values import ROLES
from tests.support.programs import ROOT

SYSTEM = ROOT / "cards/system/etc"
BASE = (ROOT / "ci/cards-base").read_text()


def units(*folders: str) -> dict[str, str]:
    paths = [path for folder in folders for path in (ROOT / f"cards/{folder}/etc/systemd/system").glob("*.*")]
    return {path.name: path.read_text() for path in paths if path.is_file()}


def test_each_unit_that_is_enabled_or_wanted_is_on_the_card() -> None:
    enabled = re.findall(r"\blaserbot-[a-z-]+", " ".join(re.findall("systemctl --quiet enable (.*)", BASE)))
    rule = (SYSTEM / "udev/rules.d/61-laserbot-led.rules").read_text()
    wanted = re.findall(r'SYSTEMD_WANTS}\+="(.*?)\.service"', rule)
    assert sorted(f"{name}.service" for name in [*enabled, *wanted]) == sorted(units("system"))


def test_the_units_that_only_one_role_has_are_enabled_or_started_by_one_that_is() -> None:
    for role in ROLES:
        [enabled] = re.findall(rf'^{role}\) own="?(.+?)"? ;;', BASE, re.MULTILINE)
        started = {re.sub(r"\.timer$", ".service", unit) for unit in enabled.split()}
        assert {*enabled.split(), *started} == set(units(f"system-{role}"))


def test_each_unit_starts_after_laserbot_txt_was_read_and_runs_a_program_that_there_is() -> None:
    found = {name: text for name, text in units("system", "system-robot").items() if name.endswith(".service")}
    modules = {name: re.findall(r"python3 -m cards\.(\w+)", text) for name, text in found.items()}
    assert modules.pop("laserbot-host-keys.service") == []
    assert modules.pop("laserbot-card.service") == ["start"]
    for name, (module,) in modules.items():
        assert (ROOT / f"cards/{module}.py").is_file()
        assert re.search(r"^After=.*\blaserbot-card\.service", found[name], re.MULTILINE), name


def test_what_is_taken_is_run_at_the_same_start() -> None:
    assert re.search(
        r"^After=.*\blaserbot-update\.service", units("system")["laserbot-containers.service"], re.MULTILINE
    )


def test_a_master_serves_only_what_is_meant_for_robots_and_where_they_ask() -> None:
    served = Store(STATE, ROOT / "no card").served
    command = f"ExecStart=/usr/bin/python3 -m http.server {follow.PORT} --directory {served}\n"
    assert command in units("system-master")["laserbot-served.service"]


def test_the_first_program_looks_where_the_mark_of_a_cut_load_is(tmp_path: Path) -> None:
    init = (ROOT / "cards/boot/init").read_text()
    [mark] = re.findall(r"^unsound=/state/changes(/.*)/(.*)$", init, re.MULTILINE)
    store = Store(tmp_path, ROOT / "no card")
    with store.loading():
        assert mark == (str(STATE), next(tmp_path.iterdir()).name)
