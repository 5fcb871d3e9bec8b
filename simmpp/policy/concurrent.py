"""Concurrent dataflow: each PE chooses between sending rays and fetching objects as it goes."""

from __future__ import annotations

from simmpp.policy.rules import DataflowPolicy, ask_rule, send_rule


@send_rule
def to_the_less_loaded(
    load: int, known_load: int, age_ps: int, waiting: int, nothing_else: int, min_load: int
) -> bool:
    """Send if my load is superior to a minimal load and to the owner's load."""
    return load > min_load and load > known_load


@ask_rule
def when_sufficient(load: int, waiting: int, nothing_else: int) -> bool:
    """Ask if the number of rays that need the object is sufficient (``ask_at_least``)."""
    return True


CONCURRENT_DATAFLOW = DataflowPolicy(
    name="concurrent",
    source="Nebel 1998, section 4.1",
    may_send=to_the_less_loaded,
    may_ask=when_sufficient,
    knows_loads=True,
)
