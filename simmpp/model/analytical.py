"""The paper's analytical model over a whole grid of nb and x (Nebel 1998, section 3).

How many rays the machine has at each step k is given: n0 at the start, constant in the permanent
regime, fewer once rays disappear. How many a PE has, and how many of these lack an object, follows
from the recurrence relations (1) and (2) with the imbalance zeta.

*Decay.* The paper says that "from a given step, rays start to disappear" but not how. Here the
number of rays at each step is that of the workload traced in lockstep (``model.lockstep``); all PEs
lose the same share of their rays.

*Imbalance.* The paper asks of zeta(i, j, k) in [-1, 1] that the number of rays stays n0 (equation
(5), whose outer sum is over i, though printed over j). Here zeta depends on the owner: zeta(i, j,
k) = z(j, k) for j != i, so that some owners' objects are wanted by all; the z of a step are evenly
spaced around 0, dealt out to the PEs anew at each step, and have the sum 0. What is left of a PE's
own rays, zeta(i, i, k), follows from each ray needing exactly one object, sum_j r(i, j, k) = n(i,
k - 1), of which (5) is the sum over i. It is (1 - x) / (x (nb - 1)) z(i, k): in [-1, 1] for x >=
1/nb, and a PE that owns an equal part of the scene holds no less.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from simmpp.common.randomness import generator
from simmpp.model.costs import Costs
from simmpp.model.formulas import makespan, object_dataflow_ps, ray_dataflow_ps
from simmpp.model.lockstep import steps_of
from simmpp.workload.workload import Workload

Floats = NDArray[np.float64]


class Rays(NamedTuple):
    """Rays of the whole machine at each of K steps."""

    tests: Floats
    """(K,): rays that need an object, sum_i n(i, k)."""
    ended: Floats
    """(K,): rays deleted."""
    repeats: Floats
    """(K,): successive steps that one entry stands for."""

    @property
    def mean_tests(self) -> float:
        """Rays of the machine in the mean over all steps."""
        return float(self.tests @ self.repeats / max(self.repeats.sum(), 1.0))


RayMessages = Literal["to-all", "with-rays", "after-runs"]
"""What a PE sends at each step of ray dataflow. The paper: one message to every other PE, with or
without rays (``to-all``). Real machines need not: only messages that carry a ray (``with-rays``),
for m rays to uniform destinations (nb - 1)(1 - (1 - 1/(nb - 1))^m); or these, and a PE sends only
when all its rays lack an object, after a run of 1 / (1 - x) tests in the mean (``after-runs``)."""

ROUNDING = 1e-9
"""Times that differ by less are equal but for the rounding of sums."""


@dataclass(frozen=True, eq=False)
class Makespans:
    """The two dataflows over a grid, in the unit of the costs."""

    processors: NDArray[np.int64]
    """(B,) int64: nb."""
    fractions: Floats
    """(X,): x."""
    object: Floats
    """(B, X): TO."""
    ray: Floats
    """(B, X): TC."""

    @property
    def ratio(self) -> Floats:
        """TC / TO (B, X), as in the paper's figure 3: above 1 object dataflow wins; 1 is a tie."""
        ratio = np.ones_like(self.ray)
        differ = np.abs(self.ray - self.object) > ROUNDING * self.object
        with np.errstate(divide="ignore"):
            np.divide(self.ray, self.object, out=ratio, where=differ)
        return ratio


def rays_of(workload: Workload) -> Rays:
    """The rays that a workload has at each step in lockstep."""
    steps = steps_of(workload)
    tests, ended = steps.tests.astype(np.float64), steps.ended.astype(np.float64)
    return Rays(tests, ended, np.ones(len(tests)))


def grouped(rays: Rays, most: int) -> Rays:
    """At most ``most`` entries, each the mean of successive steps: for maps, not for numbers."""
    n = len(rays.tests)
    if n <= most:
        return rays
    starts = np.arange(most) * n // most
    repeats = np.add.reduceat(rays.repeats, starts)
    tests = np.add.reduceat(rays.tests * rays.repeats, starts) / repeats
    ended = np.add.reduceat(rays.ended * rays.repeats, starts) / repeats
    return Rays(tests, ended, repeats)


def imbalances(steps: int, processors: int, amplitude: float, seed: int = 0) -> Floats:
    """z(j, k): (steps, nb) float64, evenly spaced between -amplitude and amplitude at each step."""
    spaced = (2.0 * np.arange(processors) + 1.0 - processors) / processors
    dealt = np.tile(amplitude * spaced, (steps, 1))
    return generator(seed, "imbalance", processors).permuted(dealt, axis=1)


def analytical(
    costs: Costs,
    processors: Sequence[int],
    fractions: Sequence[float],
    rays: Rays,
    *,
    imbalance: float = 0.0,
    seed: int = 0,
    draws: int = 1,
    ray_messages: RayMessages = "to-all",
) -> Makespans:
    """TC and TO for every nb of ``processors`` and x of ``fractions``.

    ``imbalance`` is the amplitude of zeta, from 0 to 1. A fraction below 1/nb counts as 1/nb: nb
    PEs can't hold less than the scene between them. With nb = 1 nothing is missing. With imbalance,
    times are means over ``draws`` of zeta, of the seeds from ``seed`` on.
    """
    shares = np.asarray(fractions, np.float64)
    both = np.empty((2, len(processors), len(shares)))
    for row, nb in enumerate(processors):
        # Without imbalance all PEs are alike, and one stands for all.
        width, seeds = (nb, range(seed, seed + draws)) if imbalance else (1, range(1))
        zetas = [imbalances(len(rays.tests), width, imbalance, draw) for draw in seeds]
        held = np.maximum(shares, 1.0 / nb)
        times = [_one_machine(costs, nb, held, rays, zeta, ray_messages) for zeta in zetas]
        both[:, row] = np.mean(times, axis=0)
    return Makespans(np.asarray(processors, np.int64), shares, both[0], both[1])


def _one_machine(
    costs: Costs, nb: int, x: Floats, rays: Rays, zeta: Floats, ray_messages: RayMessages
) -> tuple[Floats, Floats]:
    """TO and TC of one nb: each (X,)."""
    object_time, ray_time = np.zeros(len(x)), np.zeros(len(x))
    share = np.ones((len(x), len(zeta[0]) if len(zeta) else 1))
    chance = ((1.0 - x) / max(nb - 1, 1))[:, np.newaxis]
    for tests, ended, repeats, z in zip(
        rays.tests / nb, rays.ended / nb, rays.repeats, zeta, strict=True
    ):
        even = np.full_like(share, tests)
        asked, served = _missing(even, chance, z, nb)
        object_time += repeats * _slowest(object_dataflow_ps(costs, even, ended, asked, served))
        held = share * tests
        sent, received = _missing(held, chance, z, nb)
        tested = held - sent + received
        share = tested / tests if tests > 0 else share
        messages = _messages(held, sent, x, nb, ray_messages)
        packing = sent * costs.pack_ray + received * costs.unpack_ray
        packing += messages * (costs.pack_message + costs.unpack_message)
        ray_time += repeats * _slowest(
            ray_dataflow_ps(costs, tested, share * ended, messages, packing)
        )
    return object_time, ray_time


def _slowest(times: Floats) -> Floats:
    return makespan(times[np.newaxis])


def _missing(n: Floats, chance: Floats, z: Floats, nb: int) -> tuple[Floats, Floats]:
    """Sums of r(i, j, k) over j != i and of r(j, i, k) over j != i, by equation (1): (X, W) each.

    ``chance`` is (1 - x) / (nb - 1), (X, 1). The z of a step have the sum 0, so those of all others
    have the sum -z(i).
    """
    lacking = chance * n * (nb - 1 - z)
    wanted = chance * (1.0 + z) * (nb * n.mean(axis=1, keepdims=True) - n)
    return lacking, wanted


def _messages(held: Floats, sent: Floats, x: Floats, nb: int, ray_messages: RayMessages) -> Floats:
    """Messages of rays that a PE sends at a step, and receives: (X, W) or (1, 1)."""
    if ray_messages == "to-all" or nb < 3:
        return np.full((1, 1), float(nb - 1))
    leaving, steps = (sent, 1.0) if ray_messages == "with-rays" else (held, (1.0 - x)[:, None])
    return np.asarray(steps * (nb - 1) * -np.expm1(leaving * np.log1p(-1.0 / (nb - 1))))
