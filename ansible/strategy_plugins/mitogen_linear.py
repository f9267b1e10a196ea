"""Mitogen's way to run the tasks of a play, found by its name (ansible.cfg) wherever Python's packages are.

It keeps one Python process on each host for the whole play instead of starting one per task, which more than halves
the time of a playbook.
"""

import ansible_mitogen.loaders
import ansible_mitogen.strategy

Linear = ansible_mitogen.loaders.strategy_loader.get("linear", class_only=True)


class StrategyModule(ansible_mitogen.strategy.StrategyMixin, Linear):
    """Ansible looks for this name."""
