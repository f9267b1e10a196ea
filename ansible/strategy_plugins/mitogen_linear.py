"""Mitogen's way to run the tasks of a play, found by its name (ansible.cfg) wherever Python's packages are.

It keeps one Python process on each host for the whole play instead of starting one per task, which more than halves
the time of a playbook.
"""

import ansible_mitogen.loaders
import ansible_mitogen.strategy
from ansible.collections.list import list_collection_dirs

# Mitogen lists the collections before it runs a module of one, and to list them is to read what each of the hundred
# says of itself. Read here, it is known to the workers, which are forks of this process and else do it for every task.
list(list_collection_dirs())

Linear = ansible_mitogen.loaders.strategy_loader.get("linear", class_only=True)


class StrategyModule(ansible_mitogen.strategy.StrategyMixin, Linear):
    """Ansible looks for this name."""
