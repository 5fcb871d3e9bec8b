"""When the oracle's PE sends rays and asks for objects: the four policies as plain conditions."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from typing import Literal

from simmpp.policy.parameters import PolicyParameters

SENDS = {"object": False, "ray": True, "concurrent": True, "replicated": False}
ASKS = {"object": True, "ray": False, "concurrent": True, "replicated": False}


@dataclass(frozen=True)
class View:
    """What a PE knows of PE j, or of an object, when it decides."""

    load: int
    load_of_j: Fraction | int
    n_primaries: int
    processors: int


def may_send(policy: PolicyParameters, view: View) -> bool:
    """Whether the rays that wait for PE j's objects may go there."""
    if policy.name == "ray":
        return True
    minimum: Fraction | int = policy.min_load
    if isinstance(minimum, Fraction):
        minimum = minimum * Fraction(view.n_primaries, view.processors)
    if not view.load > minimum:
        return False
    return policy.load_info == "none" or view.load > view.load_of_j


def enough_to_ask(policy: PolicyParameters, unasked: int, nothing_else: bool) -> bool:
    """Whether an object may be asked for that so many rays need."""
    at_least = 1 if policy.name == "object" else policy.ask_at_least
    return unasked >= at_least or nothing_else


def sends_refresh(policy: PolicyParameters) -> bool:
    """Whether PEs that were not written to for long are told the load."""
    knows: Literal["piggyback", "exact", "none"] = policy.load_info
    return policy.name == "concurrent" and knows == "piggyback" and policy.refresh_ps is not None
