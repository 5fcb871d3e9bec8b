"""Finished simulations of a sweep, on disk one by one: what an interruption can't take away.

``points.jsonl`` begins with a line that says what its results are of, and has another such line
whenever a larger sweep is added to it; all other lines are outcomes. A line counts when its end is
on the disk, so a torn one is the last and was never counted.
"""

from __future__ import annotations

import json
import os
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import IO, Any

from simmpp.common.errors import ConfigError
from simmpp.common.files import Row, naming
from simmpp.sweeps.growth import Identity, conflict, joined

FILE = "points.jsonl"
FORMAT = 2


@dataclass(frozen=True)
class Outcome:
    """What a finished task leaves behind: the integers of its row, or why it failed."""

    key: str
    """The task's."""
    numbers: Row = field(default_factory=dict)
    """The cells of its row by column; empty if it failed."""
    effective_fraction: float = 0.0
    wall_s: float = 0.0
    """Placement + event loop."""
    cpu_s: float = 0.0
    """The same on the processor, whatever else runs beside it."""
    error: str = ""
    """One line; empty if all went well."""


class Results:
    """Finished simulations in memory."""

    def __init__(self) -> None:
        self.outcomes: dict[str, Outcome] = {}
        """By the task's key: the last of each."""
        self.trace_s: dict[str, float] = {}
        """Seconds that tracing took, by the workload's digest."""
        self.notices: list[str] = []
        """What the user should know of what was found."""

    def finished(self, key: str) -> bool:
        """Whether a task is done; one that failed is not."""
        return key in self.outcomes and not self.outcomes[key].error

    def add(self, outcome: Outcome) -> None:
        """Keep an outcome."""
        self.outcomes[outcome.key] = outcome

    def add_trace(self, digest: str, trace_s: float) -> None:
        """Keep how long tracing a workload took."""
        self.trace_s[digest] = trace_s

    def close(self) -> None:
        """Nothing is added from now on."""


class Journal(Results):
    """The same in one folder, which whoever opens it has claimed."""

    def __init__(self, folder: Path, identity: Identity) -> None:
        """Open or begin the journal of results that are of ``identity``, or add to it.

        Raises ConfigError if the folder holds the results of another sweep.
        """
        super().__init__()
        self.path = folder / FILE
        try:
            self._file: IO[bytes] = open(self.path, "a+b")  # noqa: SIM115
        except OSError as error:
            raise ConfigError(f"can't be written: {error.strerror}", where=str(self.path)) from None
        try:
            self._read(json.loads(json.dumps({"format": FORMAT, **identity})))
        except BaseException:
            self.close()
            raise

    def add(self, outcome: Outcome) -> None:
        """Keep an outcome; when this returns it is on the disk."""
        super().add(outcome)
        self._append(asdict(outcome))

    def add_trace(self, digest: str, trace_s: float) -> None:
        """Keep how long tracing a workload took."""
        super().add_trace(digest, trace_s)
        self._append({"traced": digest, "trace_s": trace_s})

    def close(self) -> None:
        """Nothing is added from now on."""
        with naming(self.path):  # what a full disk did not take is tried once more
            self._file.close()

    def _append(self, entry: Mapping[str, Any]) -> None:
        with naming(self.path):
            self._file.write(json.dumps(entry, allow_nan=False).encode() + b"\n")
            self._file.flush()
            os.fsync(self._file.fileno())  # a flushed line survives this process, not a power cut

    def _read(self, identity: Identity) -> None:
        self._file.seek(0)
        lines = self._file.read().splitlines(keepends=True)
        if lines and not lines[-1].endswith(b"\n"):
            self._drop(lines.pop())
        there: Identity = {}
        for number, line in enumerate(lines, 1):
            try:
                entry = json.loads(line)
                if not isinstance(entry, dict):
                    raise TypeError
                if number == 1 or "format" in entry:
                    there = entry  # a later one has all that those before it have
                else:
                    self._take(entry)
            except (TypeError, ValueError, KeyError):
                problem = "damaged: expected a line of JSON; delete the file to begin anew"
                raise ConfigError(problem, where=str(self.path), line=number) from None
        both = self._together(there, identity) if lines else identity
        if both != there:
            self._append(both)

    def _drop(self, line: bytes) -> None:
        self.notices.append(f"{self.path}: the last line was torn and is dropped")
        self._file.truncate(self._file.tell() - len(line))
        self._file.seek(0, os.SEEK_END)

    def _together(self, there: Identity, identity: Identity) -> Identity:
        if problem := conflict(there, identity):
            raise ConfigError(
                f"holds results of another sweep ({problem}); expected another --out, or an empty "
                "folder",
                where=str(self.path.parent),
            )
        return joined(there, identity)

    def _take(self, entry: dict[str, Any]) -> None:
        if "traced" in entry:
            self.trace_s[str(entry["traced"])] = float(entry["trace_s"])
        else:
            outcome = Outcome(**entry)
            self.outcomes[outcome.key] = outcome
