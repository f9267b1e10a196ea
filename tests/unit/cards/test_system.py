"""The units of a card fit together: what is enabled, wanted or run is there."""

import re

from tests.support.programs import ROOT

SYSTEM = ROOT / "cards/system/etc"
UNITS = {path.name: path.read_text() for path in (SYSTEM / "systemd/system").glob("*.service")}


def test_each_unit_that_is_enabled_or_wanted_is_on_the_card() -> None:
    enable = re.findall("systemctl --quiet enable (.*)", (ROOT / "ci/cards-base").read_text())
    enabled = re.findall(r"\blaserbot-[a-z-]+", " ".join(enable))
    rule = (SYSTEM / "udev/rules.d/61-laserbot-led.rules").read_text()
    wanted = re.findall(r'SYSTEMD_WANTS}\+="(.*?)\.service"', rule)
    assert sorted(f"{name}.service" for name in [*enabled, *wanted]) == sorted(UNITS)


def test_each_unit_starts_after_laserbot_txt_was_read_and_runs_a_program_that_there_is() -> None:
    modules = {name: re.findall(r"python3 -m cards\.(\w+)", text) for name, text in UNITS.items()}
    assert modules.pop("laserbot-host-keys.service") == []
    assert modules.pop("laserbot-card.service") == ["start"]
    for name, (module,) in modules.items():
        assert (ROOT / f"cards/{module}.py").is_file()
        assert re.search(r"^After=.*\blaserbot-card\.service", UNITS[name], re.MULTILINE), name
