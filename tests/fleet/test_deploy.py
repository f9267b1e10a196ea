"""A fleet that has been deployed once: nothing is left to do, and it passes the operator's checks."""

from tests.support.programs import ROOT
from tests.support.rehearsal import Rehearsal


def test_a_second_deploy_changes_nothing(rehearsal: Rehearsal) -> None:
    run = rehearsal.playbook("deploy")
    print(f"second run: {run.seconds:.0f} s")
    assert run.changed == 0, run.output
    assert set(run.recap) == set(rehearsal.machines)


def test_the_operators_checks_pass(rehearsal: Rehearsal) -> None:
    """All of ansible/checks, on every host, as a table."""
    run = rehearsal.playbook("check")
    rows = [line for line in run.output.splitlines() if " ok " in line]
    assert len(rows) > 15, run.output
    assert not any("FAILED" in row for row in rows)
    assert not (ROOT / "build" / "fleet-hosts.json").exists(), "what the checks were told"
