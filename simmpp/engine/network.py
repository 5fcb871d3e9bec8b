"""How long a message is on its way: at once on a network without contention, else link by link."""

from __future__ import annotations

from simmpp.common.compiled import kernel
from simmpp.engine.arrays.records import BY_PE, NONE, Row, Run
from simmpp.engine.arrays.views import free_ps, messages, topology
from simmpp.machine.limits import CLOCK_LIMIT_PS
from simmpp.machine.topology import (
    bytes_per_s,
    enter,
    held_ps,
    latency_ps,
    next_link,
    port,
)
from simmpp.machine.transfer import transfer_ps

AT_THE_START = -(1 << 31)
"""Before the port of the sender; no topology has that node."""


@kernel
def depart(s: Run, m: Row) -> None:
    """A message leaves its sender: when it arrives, or when its head is at the first link."""
    n_bytes = m.payload_bytes + s.header_bytes
    if s.contends:
        if s.service == BY_PE:
            inject(s, m)
        else:
            m.at, m.head_ps, m.arrival_ps = AT_THE_START, m.depart_ps, NONE
    else:
        m.arrival_ps = m.depart_ps + flight_ps(s, m.source, m.destination, n_bytes)


@kernel
def flight_ps(s: Run, source: int, destination: int, n_bytes: int) -> int:
    """How long a message of that many bytes, with its header, travels if nothing is in its way."""
    rate = bytes_per_s(topology(s), source, destination)
    return latency_ps(topology(s), source, destination) + transfer_ps(n_bytes, rate)


@kernel
def inject(s: Run, m: Row) -> None:
    """Take the port of the sender.

    No one else uses it and its messages reach it in order, so it can be taken now, before the clock
    says so, unless a thread or a network card sends as well. Any other port or link is taken when
    the head gets there: a message that departs later may be there sooner.
    """
    n_bytes = m.payload_bytes + s.header_bytes
    m.busy_ps = transfer_ps(n_bytes, bytes_per_s(topology(s), m.source, m.destination))
    held = held_ps(topology(s), n_bytes, m.busy_ps)
    m.at, behind_ps = enter(topology(s), m.source, m.destination)
    m.arrival_ps = NONE
    m.head_ps = _occupy(s, port(topology(s), m.source, 0), m.depart_ps, held) + behind_ps


@kernel
def move_head(s: Run, message: int) -> int:
    """The head of a message is at a link or port: it takes it as soon as that is free.

    Returns when the head is at the next one, or when the message arrives, which is known then.
    """
    m = messages(s)[message]
    if m.at == AT_THE_START:
        inject(s, m)
        return m.head_ps
    n_bytes = m.payload_bytes + s.header_bytes
    if m.at == m.destination:
        held = held_ps(topology(s), n_bytes, m.busy_ps)
        m.arrival_ps = _occupy(s, port(topology(s), m.at, 1), m.head_ps, held) + m.busy_ps
        return m.arrival_ps
    link, m.at, held, behind_ps = next_link(
        topology(s), m.source, m.at, m.destination, n_bytes, m.busy_ps
    )
    m.head_ps = _occupy(s, link, m.head_ps, held) + behind_ps
    return m.head_ps


@kernel
def _occupy(s: Run, row: int, now_ps: int, busy_ps: int) -> int:
    """Keep a link or port busy from when it is free; returns when that is."""
    start_ps = max(now_ps, free_ps(s)[row])
    # A queue can grow beyond the clock in one instant of a PE, after which the engine looks at it.
    if start_ps > CLOCK_LIMIT_PS:
        raise OverflowError("the clock")
    free_ps(s)[row] = start_ps + busy_ps
    return start_ps
