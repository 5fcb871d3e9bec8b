"""Rays to the least loaded PE that holds what they need: half of what I have more than it."""

from __future__ import annotations

from simmpp.policy.policy import Policy, hook
from simmpp.policy.view import View


@hook
def half_of_the_difference(v: View) -> int:
    """Half of what I have more than the other, as far as I know; what I sent it counts as its."""
    its = v.known_load + v.in_flight
    return (v.load - its) // 2 if v.load > v.min_load and v.load > its else 0


@hook
def when_sufficient(v: View) -> int:
    """Ask: this is asked when a sufficient number of rays needs it, or nothing else is to do."""
    return 1


HOLDERS = Policy(
    "holders",
    "Nebel 1998, section 4.1, with all PEs that hold the object in place of its owner; half of the "
    "difference as in diffusion (Heirich and Arvo 1998)",
    send=half_of_the_difference,
    ask=when_sufficient,
    candidates="holders",
    like="concurrent",
    batch="batch",
    ask_at_least="ask_at_least",
)
