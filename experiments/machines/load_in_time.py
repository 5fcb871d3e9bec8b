"""Concurrent dataflow by load in time: how long a PE takes for its rays, not how many it has."""

from __future__ import annotations

from simmpp.policy import Policy, hook
from simmpp.policy.view import View


@hook
def to_who_is_done_sooner(v: View) -> int:
    """Send all that waits if my rays take longer than a minimal load, and than the owner's."""
    mine, theirs = v.load * v.other_speed, v.known_load * v.speed
    return v.waiting if v.load > v.min_load and mine > theirs else 0


@hook
def when_sufficient(v: View) -> int:
    """As concurrent dataflow does."""
    return 1


POLICY = Policy(
    "load-in-time",
    "Nebel 1998, section 4.1, with loads over speeds",
    send=to_who_is_done_sooner,
    ask=when_sufficient,
    like="concurrent",
    batch="batch",
    ask_at_least="ask_at_least",
)
