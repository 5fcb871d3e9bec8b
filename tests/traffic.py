"""Messages without PEs: departures that are given, through the package's links and ports."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numba
import numpy as np
from by_hand import BYTE_PER_PS, OBJECT, case_of
from numpy.typing import NDArray
from oracles.hop_by_hop import Sent

from simmpp.engine.arrays.layout import MESSAGE
from simmpp.engine.arrays.views import messages
from simmpp.engine.compiled_engine import LOOP, move_first
from simmpp.engine.event_heap import EVENT_KEY, HEAD, pop, push
from simmpp.engine.initial import new_state
from simmpp.engine.pe.sending import inject
from simmpp.machine.machine import UNLIMITED, Machine
from simmpp.machine.torus import LINKS


def arrivals_ps(machine: Machine, traffic: Sequence[Sent]) -> NDArray[np.int64]:
    """(n,) when each message arrives; they are given in the order of departures and sources."""
    case = case_of(OBJECT, [], owners=(), object_bytes=(), shape=machine.shape)
    a_byte_a_ps = {"header_bytes": 0, "link_bytes_per_s": BYTE_PER_PS}
    bare = replace(machine, contention=LINKS, injection_bytes_per_s=UNLIMITED, **a_byte_a_ps)
    state = new_state(
        case.workload,
        bare,
        case.placement,
        case.policy,
        ready_order="depth-first",
        record_tests=False,
    )
    rows = np.zeros(len(traffic), MESSAGE)
    for name in ("depart_ps", "source", "number", "destination"):
        rows[name] = [getattr(sent, name) for sent in traffic]
    rows["payload_bytes"] = [sent.busy_ps for sent in traffic]
    state._put("messages", rows)
    _drive(state.runs, np.zeros(len(traffic) + 1, EVENT_KEY), np.zeros(1, LOOP))
    return state.messages["arrival_ps"].copy()


@numba.njit
def _drive(runs: Any, heap: Any, loops: Any) -> None:
    s, loop = runs[0], loops[0]
    for row in range(s.messages_n):
        m = messages(s)[row]
        inject(s, m)
        push(heap, loop, m.head_ps, HEAD + m.source, m.number, row)
    while loop.size > 0:
        if heap[0].rank >= HEAD:
            move_first(runs, heap, loop)
        else:
            pop(heap, loop)
