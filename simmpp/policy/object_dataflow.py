"""Object dataflow: a missing object is fetched, rays stay where they are."""

from __future__ import annotations

from simmpp.policy.rules import DataflowPolicy
from simmpp.policy.view import View


def at_once(view: View) -> bool:
    """Ask for every missing object as soon as one ray needs it."""
    return True


OBJECT_DATAFLOW = DataflowPolicy(
    name="object",
    source="Nebel 1998, section 2.1; Badouel & Priol 1990, Green & Paddon 1990",
    may_ask=at_once,
)
