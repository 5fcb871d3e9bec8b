"""How long computing takes: the costs of a go, as fractions."""

from __future__ import annotations

from dataclasses import dataclass, field
from fractions import Fraction
from math import floor

import numpy as np

from simmpp.common.randomness import key
from simmpp.machine.machine import Machine
from simmpp.machine.noise import ONE, factors


def rounded(number: Fraction) -> int:
    """The nearest integer, halves up."""
    return floor(number + Fraction(1, 2))


def speed_of(machine: Machine, pe: int) -> Fraction:
    """How fast a PE is: of ranges the one that it is in, of shares the one that ends behind it."""
    end = Fraction(0)
    for pes, speed in machine.speed:
        if pes.endswith("%"):
            end += Fraction(pes[:-1]) / 100
            if pe < rounded(end * machine.processors):
                return Fraction(speed)
        else:
            first, _, last = pes.partition("-")
            if int(first) <= pe <= int(last or first):
                return Fraction(speed)
    return Fraction(1)


def draw_noise(machine: Machine, seed: int, pe: int, goes: int) -> Fraction:
    """The factor of the PE's next go after so many, by numpy's own generator."""
    bits = np.random.Philox(key=[key(seed, "noise"), pe], counter=goes)
    return Fraction(factors(machine.noise)[int(bits.random_raw()) >> 56], ONE)


def speed_now(machine: Machine, pe: int, time: int) -> Fraction:
    """The same at a time: a straggler is slower."""
    straggler = machine.straggler
    late = pe == straggler.pe and straggler.from_ps <= time < straggler.to_ps
    return speed_of(machine, pe) / (Fraction(straggler.factor) if late else 1)


@dataclass
class Go:
    """What a PE computes between two looks into its inbox."""

    startup_ps: int = 0
    least_tests: int = 0
    speed: Fraction = Fraction(1)
    begin: int = 0
    noise: Fraction = Fraction(1)
    tests_ps: list[int] = field(default_factory=list)
    """What they cost."""
    rays_ps: int = 0
    finished: list[int] = field(default_factory=list)
    """Rays."""

    @classmethod
    def begun(cls, machine: Machine, speed: Fraction, begin: int) -> Go:
        """One of which nothing is done yet."""
        return cls(machine.compute_startup_ps, machine.least_tests, speed, begin)

    def at_pace(self, cost: int) -> int:
        """When what costs that is done."""
        return self.begin + self.startup_ps + rounded(rounded(cost / self.speed) * self.noise)

    @property
    def now(self) -> int:
        """When what there is so far is done."""
        return self.at_pace(sum(self.tests_ps) + self.rays_ps)

    @property
    def leaves_lanes_empty(self) -> bool:
        """Are there tests, but too few?"""
        return 0 < len(self.tests_ps) < self.least_tests

    @property
    def end(self) -> int:
        """When all of it is done."""
        if not self.leaves_lanes_empty:
            return self.now
        mean_ps = Fraction(sum(self.tests_ps), len(self.tests_ps))
        return self.at_pace(rounded(mean_ps * self.least_tests) + self.rays_ps)
