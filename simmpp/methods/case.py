"""What a method is asked: one policy on one workload, one machine and one placement."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from fractions import Fraction

from simmpp.machine.machine import Machine
from simmpp.placement.placement import Placement
from simmpp.policy.parameters import PolicyParameters
from simmpp.workload.workload import Workload


@dataclass(frozen=True, eq=False)
class Case:
    """A point of a sweep, without its names."""

    workload: Workload
    machine: Machine
    policy: PolicyParameters
    fraction: Fraction
    """x."""
    engine: str
    ready_order: str
    seed: int
    """Of the random numbers that the policy is given."""
    place: Callable[[], Placement]
    """Draws the placement, once; a method that needs none does not pay for it."""
    tick: Callable[[int], None]
    """To be told the number of rays left now and then; raises when time is up."""
