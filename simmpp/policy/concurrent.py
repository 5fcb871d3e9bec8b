"""Concurrent dataflow: each PE chooses between sending rays and fetching objects as it goes."""

from __future__ import annotations

from simmpp.policy.policy import Policy, hook
from simmpp.policy.view import View


@hook
def to_the_less_loaded(v: View) -> int:
    """Send all that waits if my load is superior to a minimal load and to the owner's load."""
    return v.waiting if v.load > v.min_load and v.load > v.known_load else 0


@hook
def when_sufficient(v: View) -> int:
    """Ask: this is asked when a sufficient number of rays needs it, or nothing else is to do."""
    return 1


CONCURRENT_DATAFLOW = Policy(
    "concurrent",
    "Nebel 1998, section 4.1",
    send=to_the_less_loaded,
    ask=when_sufficient,
    batch="batch",
    ask_at_least="ask_at_least",
)
