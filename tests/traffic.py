"""Messages without PEs: departures that are given, through the package's links and ports."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from by_hand import BYTE_PER_PS, OBJECT, case_of
from numpy.typing import NDArray
from oracles.hop_by_hop import Sent

from simmpp.common.compiled import njit
from simmpp.engine.arrays.records import MESSAGE
from simmpp.engine.arrays.views import heap, messages
from simmpp.engine.compiled_engine import move_first
from simmpp.engine.event_heap import HEAD, pop, push
from simmpp.engine.initial import new_state
from simmpp.engine.network import inject
from simmpp.machine.machine import UNLIMITED, Machine
from simmpp.machine.torus import LINKS


def arrivals_ps(machine: Machine, traffic: Sequence[Sent]) -> NDArray[np.int64]:
    """(n,) when each message arrives; they are given in the order of departures and sources."""
    a_byte_a_ps = {"link_bytes_per_s": BYTE_PER_PS, "injection_bytes_per_s": UNLIMITED}
    return arrivals_of_bytes(replace(machine, **a_byte_a_ps), traffic)  # type: ignore[arg-type]


def arrivals_of_bytes(machine: Machine, traffic: Sequence[Sent]) -> NDArray[np.int64]:
    """The same at the machine's own bandwidths."""
    case = case_of(OBJECT, [], owners=(), object_bytes=(), shape=machine.shape)
    bare = replace(machine, contention=LINKS, header_bytes=0)
    parts = (case.workload, bare, case.placement, case.policy)
    state = new_state(*parts, ready_order="depth-first")
    rows = np.zeros(len(traffic), MESSAGE)
    for name in ("depart_ps", "source", "number", "destination"):
        rows[name] = [getattr(sent, name) for sent in traffic]
    rows["payload_bytes"] = [sent.n_bytes for sent in traffic]
    state._put("messages", rows)
    state.ensure_heap()
    _drive(state.runs)
    return state.messages["arrival_ps"].copy()


@njit
def _drive(runs: Any) -> None:
    s = runs[0]
    for row in range(s.messages_n):
        m = messages(s)[row]
        inject(s, m)
        push(s, m.head_ps, HEAD + m.source, m.number, row)
    while s.n_events > 0:
        if heap(s)[0].rank >= HEAD:
            move_first(s)
        else:
            pop(s)
