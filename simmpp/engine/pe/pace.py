"""How long computing takes: what tests and rays cost, at the pace of a PE and of the moment.

A PE of speed s takes cost / s, a straggler its factor times as long, and with noise each go at
computing takes a factor of its own. What a go has cost so far is scaled as a whole, first by speed
and straggler, then by noise, and each time rounded to picoseconds: nothing adds up.

An example: startup 10, at least 4 tests, speed 2. Two tests of 3 and 6 and a ray of 5 cost 9, which
are four of the mean cost of 4.5: 18. So the go takes 10 + round((18 + 5) / 2) = 22, and the ray is
finished then; had no lanes been left empty, it had taken 10 + round((9 + 5) / 2) = 17.
"""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from simmpp.common.compiled import kernel
from simmpp.common.philox import philox
from simmpp.common.randomness import key
from simmpp.engine.arrays.records import NONE, Row, Run
from simmpp.engine.arrays.views import noise_factors, pes, test_ps, test_scales
from simmpp.machine.machine import Machine
from simmpp.machine.noise import ONE, factors
from simmpp.machine.uneven import NOBODY, speeds_of

_DRAW_BITS = 63 - 8
"""Of a draw, those below the ones that choose among 256 factors."""


class Pace(NamedTuple):
    """Costs times ``times`` / ``per``, then times ``noise`` / ONE."""

    times: int
    per: int
    noise: int


@kernel
def pace_of(s: Run, me: int, now_ps: int) -> Pace:
    """The pace of what a PE begins to compute now."""
    pe = pes(s)[me]
    times, per, noise = pe.pace_times, pe.pace_per, ONE
    if s.uneven:
        if me == s.straggler and s.straggler_from_ps <= now_ps < s.straggler_to_ps:
            times, per = times * s.straggler_times, per * s.straggler_per
        if noise_factors(s).size > 0:
            pe.goes += 1
            noise = noise_factors(s)[philox(s.noise_key, me, pe.goes) >> _DRAW_BITS]
    return Pace(times, per, noise)


@kernel
def paced_ps(cost_ps: int, pace: Pace) -> int:
    """How long what costs that takes; looked at for every test, so most machines go no further."""
    if pace.times == pace.per and pace.noise == ONE:
        return cost_ps
    return _unevenly_ps(cost_ps, pace)


@kernel
def _unevenly_ps(cost_ps: int, pace: Pace) -> int:
    if pace.times != pace.per:
        cost_ps = scaled(cost_ps, pace.times, pace.per)
    return scaled(cost_ps, pace.noise, ONE) if pace.noise != ONE else cost_ps


@kernel
def scaled(number: int, times: int, per: int) -> int:
    """number * times / per, halves rounded up; exact for ``times`` * ``per`` < 2^63."""
    whole = number // per
    rest = (number - whole * per) * times
    more = rest // per
    rest -= more * per
    return whole * times + more + (1 if rest >= per - rest else 0)


@kernel
def took(s: Run, me: int, cost_ps: int, tests: int, done: int, pace: Pace) -> int:
    """How long a go at computing has taken, with its startup, if it made some tests and finished
    ``done`` rays that cost so much."""
    took_ps = paced_ps(cost_ps, pace)
    pe, filled_ps = pes(s)[me], took_ps
    if 0 < tests < s.least_tests:
        of_tests_ps = cost_ps - done * s.ray_ps
        cost_ps += scaled(of_tests_ps, s.least_tests, tests) - of_tests_ps
        filled_ps = paced_ps(cost_ps, pace)
    pe.launch_ps += s.compute_startup_ps + filled_ps - took_ps
    return s.compute_startup_ps + filled_ps


@kernel
def cost_of_test_ps(s: Run, ray: int, obj: int) -> int:
    """What one test of a ray costs, whoever makes it."""
    if s.test_scales_n == 0:
        return test_ps(s)[obj]
    return test_ps(s)[obj] << np.int64(test_scales(s)[ray])


@kernel
def test_here_ps(s: Run, me: int, obj: int) -> int:
    """What one test of a ray that costs no more than others takes a PE, by its speed."""
    pe = pes(s)[me]
    return scaled(test_ps(s)[obj], pe.pace_times, pe.pace_per)


@kernel
def speed_of(pe: Row) -> int:
    """Tests of a PE in the time of 1000 on one of speed 1."""
    return scaled(1000, pe.pace_per, pe.pace_times)


# --- at the start of a run ---


def pace_scalars(machine: Machine, seed: int) -> dict[str, int]:
    """What is the same for all PEs."""
    straggler = machine.straggler
    factor = Fraction(straggler.factor)
    return {
        "uneven": machine.is_uneven,
        "noise_key": key(seed, "noise"),
        "straggler": NONE if straggler == NOBODY else straggler.pe,
        "straggler_times": factor.numerator,
        "straggler_per": factor.denominator,
        "straggler_from_ps": straggler.from_ps,
        "straggler_to_ps": straggler.to_ps,
    }


def noise_array(machine: Machine) -> NDArray[np.int64]:
    """Factors to draw from; none without noise."""
    return np.array(factors(machine.noise) if machine.noise != "0" else (), np.int64)


def pace_columns(machine: Machine) -> Mapping[str, list[int] | int]:
    """Of each PE."""
    if not machine.speed:
        return {"pace_times": 1, "pace_per": 1}
    speeds = speeds_of(machine.speed, machine.processors)
    times, per = [of.denominator for of in speeds], [of.numerator for of in speeds]
    return {"pace_times": times, "pace_per": per}
