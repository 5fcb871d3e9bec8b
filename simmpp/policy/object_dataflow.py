"""Object dataflow: a missing object is fetched, rays stay where they are."""

from __future__ import annotations

from simmpp.policy.rules import DataflowPolicy, ask_rule


@ask_rule
def at_once(load: int, waiting: int, nothing_else: int) -> bool:
    """Ask for every missing object as soon as one ray needs it."""
    return True


OBJECT_DATAFLOW = DataflowPolicy(
    name="object",
    source="Nebel 1998, section 2.1; Badouel & Priol 1990, Green & Paddon 1990",
    may_ask=at_once,
    ask_at_least=1,
)
