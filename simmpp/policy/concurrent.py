"""Concurrent dataflow: each PE chooses between sending rays and fetching objects as it goes."""

from __future__ import annotations

from simmpp.policy.rules import DataflowPolicy
from simmpp.policy.view import View


def to_the_less_loaded(view: View) -> bool:
    """Send a full batch if my load is superior to a minimal load and to the owner's load."""
    if view.waiting < view.batch and not view.nothing_else:
        return False
    return view.load > view.min_load and view.load > view.known_load


def when_sufficient(view: View) -> bool:
    """Ask if the number of rays that need the object is sufficient, or there is nothing else."""
    return view.waiting >= view.ask_at_least or view.nothing_else != 0


CONCURRENT_DATAFLOW = DataflowPolicy(
    name="concurrent",
    source="Nebel 1998, section 4.1",
    may_send=to_the_less_loaded,
    may_ask=when_sufficient,
    send_from="batch",
    ask_from="ask_at_least",
    knows_loads=True,
)
