"""Mitogen's way to run the tasks of a play, found by its name (ansible.cfg) wherever Python's packages are.

It keeps one Python process on each host for the whole play instead of starting one per task, which more than halves
the time of a playbook.
"""

import sys

import ansible_mitogen.loaders
import ansible_mitogen.strategy
from ansible.collections.list import list_collection_dirs

# Mitogen lists the collections before it runs a module of one, and to list them is to read what each of the hundred
# says of itself. Read here, it is known to the workers, which are forks of this process and else do it for every task.
list(list_collection_dirs())

Linear = ansible_mitogen.loaders.strategy_loader.get("linear", class_only=True)


class StrategyModule(ansible_mitogen.strategy.StrategyMixin, Linear):
    """Ansible looks for this name."""

    def _queue_task(self, *arguments, **named):
        """Starts a worker. Python ignores exceptions while it forks; Ctrl-C, which is one, is raised after that."""
        interrupts = []

        def look(ignored):
            if ignored.exc_type is KeyboardInterrupt:
                interrupts.append(ignored.exc_value)
            else:
                sys.__unraisablehook__(ignored)

        sys.unraisablehook = look
        try:
            result = super()._queue_task(*arguments, **named)
        finally:
            sys.unraisablehook = sys.__unraisablehook__
        if interrupts:
            raise interrupts[0]
        return result
