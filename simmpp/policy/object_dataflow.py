"""Object dataflow: a missing object is fetched, rays stay where they are."""

from __future__ import annotations

from simmpp.policy.policy import Policy, hook
from simmpp.policy.view import View


@hook
def at_once(v: View) -> int:
    """Ask for every missing object as soon as one ray needs it."""
    return 1


OBJECT_DATAFLOW = Policy(
    "object",
    "Nebel 1998, section 2.1; Badouel & Priol 1990, Green & Paddon 1990",
    ask=at_once,
)
