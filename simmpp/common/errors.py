"""The tree of errors that simmpp raises; everything else is a bug.

SimmppError
+-- InputError      what the user gave is wrong: exit code 2, one line
|   +-- ConfigError     in a YAML file, a --set or a call
|   +-- SceneError      in an NFF or mesh file
|   +-- WorkloadError   in a workload file
+-- ModelError      an invariant of the simulated machine broke: a bug, or a policy that starves
"""

from __future__ import annotations


class SimmppError(Exception):
    """Base of every error that simmpp raises on purpose."""


class InputError(SimmppError):
    """The user's input is wrong.

    The message is one line: where (file, line, key), the value, and what was expected.
    """

    def __init__(self, problem: str, *, where: str = "", line: int | None = None) -> None:
        place = f"{where}:{line}: " if where and line else f"{where}: " if where else ""
        super().__init__(f"{place}{problem}")
        self.problem, self.where, self.line = problem, where, line


class ConfigError(InputError):
    """A configuration key, a ``--set`` or an argument of the Python calls is wrong."""


class SceneError(InputError):
    """A scene file can't be read, or does not describe a scene."""


class WorkloadError(InputError):
    """A workload file can't be read, or contradicts itself."""


class CacheWarning(UserWarning):
    """What would be kept for the next run can't be; this one goes on."""


class ModelError(SimmppError):
    """An invariant of the simulated machine broke; the message holds the state."""
