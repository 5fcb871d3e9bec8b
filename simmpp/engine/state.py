"""The state of a run: the arrays that compiled functions change, and what Python reads of them."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from simmpp.common.compiled import entry_point, kernel, njit
from simmpp.common.errors import ModelError
from simmpp.engine.arrays.hashtable import USED
from simmpp.engine.arrays.layout import ARRAYS, COUNTERS, PARAMETERS, REPORT, RUN
from simmpp.engine.arrays.records import BINS, NONE, SIZES, Run
from simmpp.engine.arrays.views import message_marks
from simmpp.engine.record.counters import Counters, end_counting
from simmpp.engine.record.log import LOG_ROWS, Sink, hand_on, hand_on_last
from simmpp.engine.residency import Arrays
from simmpp.machine.messages import MESSAGE_KINDS, USER_WORDS


class State:
    """One run: arrays by name, and the record that compiled code gets.

    The arrays of tables are reserved at an upper bound, but the system gives memory only to pages
    that are touched; the table of messages grows.
    """

    def __init__(self, arrays: Arrays, parameters: dict[str, int], log: Sink | None = None) -> None:
        self.log = log
        """What gets the event log, if there is one."""
        self.infeasible = ""
        """Why the run could not be brought to its end."""
        self.arrays: dict[str, NDArray[Any]] = {}
        self.runs = np.zeros(1, RUN)
        """(1,) RUN: the argument of every compiled function of the model."""
        values = dict.fromkeys(RUN.fields or (), 0) | parameters
        for name, array in arrays.items():
            self.arrays[name] = array = np.ascontiguousarray(array, ARRAYS[name].dtype)
            values[f"{name}_at"], values[f"{name}_n"] = array.ctypes.data, len(array)
        self.runs[0] = tuple(values.values())  # at once, for each by itself takes a while
        first = len(PARAMETERS) + len(COUNTERS)
        self._room_lacking = _room_entry()
        self.report = self.runs.view(np.int64)[first : first + len(REPORT)]
        """(5,) int64: the REPORT fields of the record."""

    def _put(self, name: str, array: NDArray[Any]) -> None:
        self.arrays[name] = array = np.ascontiguousarray(array, ARRAYS[name].dtype)
        self.runs[f"{name}_at"], self.runs[f"{name}_n"] = array.ctypes.data, len(array)

    def __getitem__(self, scalar: str) -> int:
        """One parameter or counter."""
        return int(self.runs[scalar][0])

    @property
    def pes(self) -> NDArray[np.void]:
        """(nb,) PE."""
        return self.arrays["pes"]

    @property
    def messages(self) -> NDArray[np.void]:
        """(capacity,) MESSAGE: those in flight or in an inbox, and free places."""
        return self.arrays["messages"]

    def ensure_room(self, now_ps: int) -> None:
        """See to it that all messages that one more step can send at most have a place.

        So have their rows in the event log: what ended before ``now_ps``, the time of that step,
        is handed on if the log is full.
        """
        most = self._room_lacking(self.runs)
        if most == 0:
            return
        if len(self.messages) - self.arrays["message_marks"][USED] < most:
            self._grow("messages", 2 * len(self.messages) + len(self.arrays["outbox"]))
            if self["talks"]:
                self._grow("user_words", USER_WORDS * len(self.messages))
        if self.log is not None and len(self.arrays["log"]) - self["n_logged"] < most + 2:
            self.runs["n_logged"] = hand_on(self._logged(), now_ps, self.log)
            if len(self.arrays["log"]) - self["n_logged"] < most + 2 + LOG_ROWS:
                self._grow("log", 2 * len(self.arrays["log"]))

    def ensure_heap(self) -> None:
        """See to it that the heap has a place for every message and all that takes turns, and a
        round's beginning.

        And for twice the instants that have come to nothing, and one for each PE, as these grow.
        """
        needed = len(self.messages) + len(self.arrays["processes"]) + 2
        if self["talks"]:
            needed += 2 * self["n_stale"] + len(self.pes)
        if len(self.arrays["heap"]) < needed:
            self._grow("heap", needed)

    def starve(self) -> None:
        """Rays are left and nothing is scheduled: a result where no PE may escape.

        Raises ModelError elsewhere: a bug, or a policy that starves.
        """
        if not self["bounded"] or self["escapes"]:
            raise ModelError(starved(self))
        self.infeasible = stuck(self)

    def close_log(self) -> None:
        """Hand on what is left of the event log."""
        if self.log is not None:
            end_ps = self["last_ray_ps"]
            self.runs["n_logged"] = hand_on(self._logged(), end_ps, self.log)
            hand_on_last(self._logged(), end_ps, self.log)

    def sent_until(self, end_ps: int) -> tuple[tuple[int, ...], int]:
        """Messages by kind and bytes that had departed then.

        Only loads, messages of the policy's own and those for pixels can be later.
        """
        used = self.messages[: self.arrays["message_marks"][USED]]
        late = used[(used["kind"] != NONE) & (used["depart_ps"] > end_ps)]
        counts = np.bincount(late["kind"], minlength=len(MESSAGE_KINDS))
        by_kind = self.arrays["sent_by_kind"] - counts
        late_bytes = int(late["payload_bytes"].sum()) + self["header_bytes"] * len(late)
        return tuple(by_kind.tolist()), self["bytes_sent"] - late_bytes

    def counters(self) -> Counters:
        """What was counted; the run must be over."""
        end_counting(self.runs)
        n, at = len(self.pes), self.arrays
        moments, traffic = at["moments"], at["traffic"].reshape(n, n)
        return Counters(
            bin_ps=1 << self["bin_width"],
            compute_ps=at["compute_bins"].reshape(n, BINS),
            communication_ps=at["communication_bins"].reshape(n, BINS),
            finished=moments["finished"],
            batches=np.array([moments[name] for name in ("batches", "rays", "largest")]),
            messages=traffic["messages"],
            bytes=traffic["bytes"],
            sizes=at["sizes"].reshape(-1, SIZES),
            load_ps=at["slices"]["load_ps"],
            held=at["held_bins"].reshape(-1, BINS),
        )

    def _logged(self) -> NDArray[np.void]:
        return self.arrays["log"][: self["n_logged"]]

    def _grow(self, name: str, length: int) -> None:
        """Make an array longer."""
        before = self.arrays[name]
        longer = np.zeros(length, before.dtype)
        longer[: len(before)] = before
        self._put(name, longer)


@kernel
def room_lacking(s: Run) -> int:
    """How many messages one more step may send, if there might be no room for them; else 0.

    A step sends no more than a message for each ray that is left, and a batch and a load to each
    PE; in the log each has a row, and so has what the step does before.
    """
    most = min(s.outbox_n, s.rays_left + 2 * s.processors)
    if s.messages_n - message_marks(s)[USED] < most or (s.logs and s.log_n - s.n_logged < most + 2):
        return most
    return 0


@njit
def _room_lacking(runs: NDArray[np.void]) -> int:
    return room_lacking(runs[0])


@cache
def _room_entry() -> Callable[..., int]:
    return entry_point(_room_lacking, np.zeros(1, RUN))


# --- the state of a machine that stands still, in words ---


def starved(state: State) -> str:
    """What to say when rays are left and nothing is scheduled: a bug, or a policy that starves."""
    load = state.pes["load"]
    holders = [f"PE {k}: {load[k]} rays, all waiting" for k in load.nonzero()[0][:5]]
    return (
        f"{state['rays_left']} rays are left and nothing is scheduled "
        f"after {state['tests']} tests: {'; '.join(holders)}"
    )


def stuck(state: State) -> str:
    """What to say when no PE can go on, and none may escape."""
    waiting = state.pes["load"] - (state.pes["pixel_end"] - state.pes["pixel"])
    pe = int(waiting.argmax())
    return f"PE {pe} is stuck with {waiting[pe]} rays, of {state['rays_left']} that are left"
