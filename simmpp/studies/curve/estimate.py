"""Profits at any x from one simulation each of a dozen fractions, and a smooth curve through them.

The profits of a point scatter by 2 to 6 % from seed to seed, for residents are drawn, so a sweep
repeats every point. But neighbours along x have nearly the same mean: simulate each fraction once,
with residents that make up for each other (``rotated``), and smooth the logarithms of the profits.
Every simulation is a full one, so there is no error but that of the draws and of the smoothing.
What it saves, how it errs and what else was tried: experiments/rungs/README.md.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction

import numpy as np
from numpy.typing import NDArray

from simmpp.common.documented import documented
from simmpp.common.errors import ConfigError
from simmpp.common.units import share
from simmpp.common.validate import require_kind, require_whole
from simmpp.engine.result import Result
from simmpp.engine.simulate import DEFAULT_ENGINE, simulate
from simmpp.machine.machine import Machine
from simmpp.placement.place import rotated
from simmpp.placement.placement import Placement, PlacementRules, island_of
from simmpp.placement.residents import resident_count
from simmpp.policy.parameters import REFERENCE, PolicyParameters, policy_of
from simmpp.run.profit import ratio
from simmpp.studies.curve.smooth import smooth
from simmpp.workload.workload import Workload

NODES = tuple(Fraction(n, 20) for n in (2, 4, 6, 8, 10, 12, 14, 16, 17, 18, 19))
"""Fractions that are simulated besides the least one wanted: closer together near 1, where curves
are steep and runs are cheap. At 1 there is nothing to send, and all policies are the same.
ESTIMATE, compared with sparser ones on the paper's scenes."""
APART = Fraction(1, 25)
"""How far above the least fraction the next node has to be. ESTIMATE."""

Floats = NDArray[np.float64]


@documented
@dataclass(frozen=True)
class Estimate:
    """The profits of one policy at one fraction, each with its standard error."""

    policy: str
    """Its label or name."""
    fraction: Fraction
    """Share of the scene on each PE, as asked for."""
    time_profit: float
    """Makespan of object dataflow / makespan of the policy."""
    time_error: float
    """Standard error of the time profit; 0 where nothing is drawn."""
    message_profit: float
    """Messages of object dataflow / messages of the policy."""
    message_error: float
    """Standard error of the message profit; 0 where nothing is drawn."""


@dataclass(frozen=True)
class Node:
    """The profits of one policy on one placement."""

    share: float
    """Residents of a PE / objects."""
    drawn: bool
    """Are some residents a matter of luck?"""
    time: float
    messages: float


def estimate(
    workload: Workload,
    machine: Machine,
    policies: Sequence[PolicyParameters | str],
    fractions: Sequence[Fraction | float | str],
    *,
    rules: PlacementRules | None = None,
    engine: str = DEFAULT_ENGINE,
    ready_order: str = "depth-first",
    replicates: int = 1,
    seed: int = 0,
) -> list[Estimate]:
    """Profits over object dataflow of each policy at each fraction, residents drawn at random.

    Simulates object dataflow and the policies at about a dozen fractions, ``replicates`` times,
    however many are wanted. A profit is the geometric mean over draws; where nothing is drawn it
    is exact and has the error 0. Errors suppose that logarithms scatter alike at all fractions.

    Raises ConfigError if owners or pixels are random too, or a number is out of its range.
    """
    require_kind("workload", workload, Workload)
    require_kind("machine", machine, Machine)
    require_kind("policies", policies, Sequence)
    named = [policy_of(policy, "policies") for policy in policies]
    wanted = _checked(fractions, replicates, seed)
    rules = PlacementRules() if rules is None else rules
    require_kind("rules", rules, PlacementRules)
    if "random" in (rules.owners, rules.pixels):
        raise ConfigError("curve: random owners or pixels: expected residents alone to be drawn")

    def run(placement: Placement, policy: PolicyParameters) -> Result:
        return simulate(
            workload, machine, placement, policy, engine=engine, ready_order=ready_order
        )

    xs, island = node_fractions(min(wanted)), island_of(rules, machine.processors)
    nodes: list[list[Node]] = [[] for _ in named]
    for draw in range(seed, seed + replicates):
        placements = rotated(workload, machine.processors, xs, rules, draw)
        for x, placement in zip(xs, placements, strict=True):
            at = share_of(x, workload.n_objects, island)
            reference = run(placement, PolicyParameters(REFERENCE))
            for of_policy, policy in zip(nodes, named, strict=True):
                of_policy.append(node_of(placement, at, reference, run(placement, policy)))
    shares = np.array([share_of(x, workload.n_objects, island) for x in wanted])
    return [
        Estimate(policy.title, fraction, *numbers)
        for policy, of_policy in zip(named, nodes, strict=True)
        for fraction, *numbers in zip(wanted, *profits_at(shares, of_policy), strict=True)
    ]


def _checked(
    fractions: Sequence[Fraction | float | str], replicates: int, seed: int
) -> list[Fraction]:
    """The fractions as such; numbers out of their range are a ConfigError."""
    require_kind("fractions", fractions, Sequence)
    require_whole("seed", seed, 0)
    try:
        require_whole("replicates", replicates, 1)
        wanted = [share(fraction) for fraction in fractions]
    except ConfigError:
        wanted = []
    if not wanted:
        raise ConfigError("curve: expected fractions from 0 to 1, and 1 replicate or more")
    return wanted


def node_fractions(least: Fraction) -> list[Fraction]:
    """The fractions to simulate for a curve from ``least`` to 1."""
    return [least, *(x for x in NODES if x >= least + APART)]


def share_of(fraction: Fraction, n_objects: int, island: int) -> float:
    """What a fraction comes to: residents of a PE / objects, where its own are always there.

    An island of PEs owns all objects, without islands the whole machine.
    """
    if n_objects == 0:
        return 1.0
    return max(resident_count(fraction, n_objects) / n_objects, 1 / island)


def node_of(placement: Placement, at: float, reference: Result, result: Result) -> Node:
    """What ``result`` gains over ``reference`` on the same placement, whose share is ``at``."""
    return Node(
        share=at,
        drawn=at < 1 and len(placement.replica_objects) > 0,
        time=ratio(reference.makespan_ps, result.makespan_ps),
        messages=ratio(reference.messages, result.messages),
    )


def profits_at(shares: Floats, nodes: Sequence[Node]) -> tuple[list[float], ...]:
    """Time profit and its error, message profit and its error at each of ``shares``."""
    remote = [node for node in nodes if node.share < 1]
    time, time_error = _curve(shares, remote, [node.time for node in remote])
    messages, message_error = _curve(shares, remote, [node.messages for node in remote])
    return time.tolist(), time_error.tolist(), messages.tolist(), message_error.tolist()


def _curve(
    shares: Floats, nodes: Sequence[Node], profits: Sequence[float]
) -> tuple[Floats, Floats]:
    """Geometric means of profits along x, and their errors.

    Where nothing is drawn a profit is what was simulated, but for its neighbours no better a guide
    than others. With everything resident it is 1, which a curve need not tend to.
    """
    logs = np.log(profits)
    if not nodes:
        mean, error = np.zeros(len(shares)), np.zeros(len(shares))
    elif not np.isfinite(logs).all() or np.ptp(logs) == 0:  # nothing is sent, or nothing is gained
        mean, error = np.full(len(shares), logs.mean()), np.zeros(len(shares))
    else:
        mean, error = smooth(np.array([node.share for node in nodes]), logs, shares)
    certain = {node.share: log for node, log in zip(nodes, logs, strict=True) if not node.drawn}
    for share_of_it, log in (certain | {1.0: 0.0}).items():
        mean[shares == share_of_it], error[shares == share_of_it] = log, 0.0
    profit, deviation = np.exp(mean), np.zeros(len(shares))
    return profit, np.multiply(profit, error, out=deviation, where=error > 0)
