"""A model of costs: rays go where they are expected to be done sooner, all things counted.

A ray that waits is done here when what is held is done and its object has been fetched, there when
what the other holds is done and the ray has been sent; a fetch is shared by the rays that wait for
the object, a message by those in it. The estimate of a ray's time, in picoseconds, is learnt.

Decided here, as measured on T3E, a CPU and a GPU cluster: a ray's time is what its tests take, not
all that the PE does (messages made it look loaded where they are dear, and it sent too little);
rays go to any PE that holds what they need, half of the difference, so that no one is flooded; and
no minimal load, as sending what is soon wanted here costs more than it gains by the same estimate.
What it does not see is the work that a fetch makes for others: where objects are large and serve a
ray or two it fetches what ray dataflow would send, and takes many times as long.
"""

from __future__ import annotations

from simmpp.policy.policy import Policy, hook
from simmpp.policy.view import View

RAY_PS, FINISHED, COMPUTE_PS = range(3)
"""Words of the memory: a ray's time, and what had been done when it was learnt last."""
SMOOTH = 8
"""What was learnt last counts 1/8 (V. Jacobson's gain for round-trip times, SIGCOMM 1988)."""


@hook
def where_done_sooner(v: View) -> int:
    """Half of what evens out the two times; all, as long as no ray has been finished here."""
    n = v.finished - v.memory[FINISHED]
    if n > 0:
        of_late_ps = (v.compute_ps - v.memory[COMPUTE_PS]) // n
        change_ps = of_late_ps - v.memory[RAY_PS]
        v.memory[RAY_PS] += change_ps // SMOOTH if v.memory[FINISHED] > 0 else change_ps
        v.memory[FINISHED], v.memory[COMPUTE_PS] = v.finished, v.compute_ps
    ray_ps = v.memory[RAY_PS]
    fetch_ps = (v.fetch_ps + v.fetch_flight_ps) // v.waiting
    send_ps = (v.send_ps + v.receive_ps + v.flight_ps) // v.waiting
    gain_ps = (v.load - v.known_load - v.in_flight) * ray_ps + fetch_ps - send_ps
    if gain_ps <= 0:
        return 0
    return max(1, gain_ps // (2 * ray_ps)) if ray_ps > 0 else v.waiting


@hook
def when_worth_it(v: View) -> int:
    """Ask if the tests that this allows take as long as the fetch keeps me, or if I am idle."""
    return 1 if v.nothing_else or v.unasked * v.test_ps >= v.send_ps + v.receive_ps else 0


COST = Policy(
    "cost",
    "The choice of Nebel 1998, section 4.1, by estimated times of completion (Ibarra and Kim 1977)",
    send=where_done_sooner,
    ask=when_worth_it,
    candidates="holders",
    like="concurrent",
    batch="batch",
    ask_at_least="ask_at_least",
)
