"""Islands: equal parts of the machine that own the whole scene each and send one another nothing.

All own it alike, so one list of owners, counted from the first PE of an island, serves all. Hooks
see their island as if it were the machine.
"""

from __future__ import annotations

from simmpp.common.compiled import kernel
from simmpp.engine.arrays.records import Run
from simmpp.engine.arrays.views import holder_offsets, holder_pes, owners, pes


@kernel
def owns(s: Run, me: int, obj: int) -> bool:
    """Is the PE the owner of the object in its island?"""
    return owners(s)[obj] == pes(s)[me].place


@kernel
def owner_of(s: Run, me: int, obj: int) -> int:
    """The PE that owns the object in the island of PE ``me``."""
    return pes(s)[me].base + owners(s)[obj]


@kernel
def holders_of(s: Run, me: int, obj: int) -> tuple[int, int]:
    """Where ``holder_pes`` has the PEs of the island that hold the object for good."""
    low, high = holder_offsets(s)[obj], holder_offsets(s)[obj + 1]
    if s.island == s.processors:
        return low, high
    base = pes(s)[me].base
    return _first_from(s, low, high, base), _first_from(s, low, high, base + s.island)


@kernel
def _first_from(s: Run, low: int, high: int, pe: int) -> int:
    """The first of the holders from low to high, in rising order, that is that PE or above."""
    while low < high:
        middle = (low + high) // 2
        if holder_pes(s)[middle] < pe:
            low = middle + 1
        else:
            high = middle
    return low
