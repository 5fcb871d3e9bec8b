"""The thread beside a PE that receives its messages: ``machine.service: thread``.

It alternates between two instants, which fall together where it sent no answer: one message has
been unpacked, and it begins with the next. What is not only requests it hands over to its PE, which
takes it over as it would receive it (``receiving.receive``).
"""

from __future__ import annotations

from simmpp.common.compiled import kernel
from simmpp.engine.arrays.records import BEGIN, NONE, SLEEP, Run
from simmpp.engine.arrays.views import messages, pes
from simmpp.engine.pe.peers import hear_load
from simmpp.engine.pe.receiving import unpacking_ps
from simmpp.engine.pe.sending import answer, forget
from simmpp.engine.record.log import note_serve
from simmpp.machine.limits import CLOCK_LIMIT_PS
from simmpp.machine.messages import REQUEST


@kernel
def serve(s: Run, me: int, message: int, now_ps: int) -> int:
    """Act on an instant of the thread of PE ``me``; ``message`` is its oldest one, or NONE.

    Returns the time of its next instant in picoseconds, or SLEEP until a message arrives. The
    record's REPORT fields then hold whether the message was consumed, the number of messages in the
    outbox, and the message that is handed over, or NONE.
    """
    s.phase, s.consumed, s.n_sent, s.handed = BEGIN, 0, 0, NONE
    pe = pes(s)[me]
    end_ps = now_ps
    if pe.in_hand != NONE:
        end_ps = _finish(s, me, pe.in_hand, now_ps)
        pe.in_hand = NONE
    # What was sent departs by then; else the next message is begun in this very instant.
    if s.n_sent == 0:
        if message == NONE:
            return SLEEP
        end_ps = _begin(s, me, message, now_ps)
    pe.service_ps += end_ps - now_ps
    pe.served_until_ps = end_ps
    if end_ps > CLOCK_LIMIT_PS:
        raise OverflowError("the clock")
    return end_ps


@kernel
def _begin(s: Run, me: int, message: int, now_ps: int) -> int:
    """Unpack a message; returns the end of that."""
    end_ps = now_ps + unpacking_ps(s, me, message)
    pes(s)[me].in_hand = message
    s.consumed = 1
    s.activities += 1
    s.received += 1
    if s.logs:
        note_serve(s, me, message, now_ps, end_ps)
    return end_ps


@kernel
def _finish(s: Run, me: int, message: int, now_ps: int) -> int:
    """A message is unpacked: hear the load, answer, hand over; returns the end of that."""
    m = messages(s)[message]
    if s.listens:
        hear_load(s, me, m, now_ps)
    end_ps = answer(s, me, message, now_ps, True)
    if m.kind == REQUEST:
        forget(s, message)
    else:
        s.handed = message
    return end_ps
