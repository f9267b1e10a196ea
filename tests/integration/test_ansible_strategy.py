"""How ansible/strategy_plugins runs playbooks."""

from pathlib import Path

from tests.support.programs import ROOT, Program

PLAY = """
- hosts: localhost
  connection: local
  gather_facts: false
  tasks:
    - ansible.builtin.command: sleep 60
"""
IMPATIENT = '''
import os
import signal

from ansible.plugins.callback import CallbackBase


class CallbackModule(CallbackBase):
    """Presses Ctrl-C while the worker is forked."""

    CALLBACK_VERSION = 2.0
    CALLBACK_NAME = "impatient"

    def v2_runner_on_start(self, host, task):
        os.register_at_fork(after_in_parent=lambda: os.kill(os.getpid(), signal.SIGINT))
'''


def test_ctrl_c_ends_a_playbook_even_while_it_forks_a_worker(tmp_path: Path) -> None:
    """Python ignores an exception there, and the playbook would wait for its task, a minute."""
    (tmp_path / "play.yml").write_text(PLAY)
    (tmp_path / "impatient.py").write_text(IMPATIENT)
    run = Program(
        [str(ROOT / ".venv/bin/ansible-playbook"), "-i", "localhost,", str(tmp_path / "play.yml")],
        {
            "ANSIBLE_CONFIG": str(ROOT / "ansible/ansible.cfg"),
            "ANSIBLE_STRATEGY_PLUGINS": str(ROOT / "ansible/strategy_plugins"),
            "ANSIBLE_CALLBACK_PLUGINS": str(tmp_path),
            "ANSIBLE_CALLBACKS_ENABLED": "impatient",
            "ANSIBLE_HOME": str(tmp_path / "home"),
            "ANSIBLE_LOCAL_TEMP": str(tmp_path / "home/tmp"),
        },
    )
    try:
        assert run.process.wait(40) == 99, run.output
    finally:
        run.kill()
    assert "User interrupted execution" in run.output
