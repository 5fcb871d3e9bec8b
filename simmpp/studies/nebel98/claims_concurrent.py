"""Claims about concurrent dataflow: figures 4 to 6 of Nebel 1998, and the abstracts."""

from __future__ import annotations

from itertools import combinations

import numpy as np

from simmpp.policy.parameters import REFERENCE
from simmpp.studies.nebel98.evidence import (
    At,
    Evidence,
    criteria,
    largest,
    largest_at,
    mean_profits,
    of_scene,
    partitioned,
    points,
    rank_correlation,
    span,
)
from simmpp.studies.nebel98.verdict import Criterion, Verdict, verdict
from simmpp.sweeps.ratios import (
    CONCURRENT,
    MAKESPAN,
    MESSAGES,
    RAY,
    REPLICATED,
    CurvePoint,
    RowIndex,
    mean,
)

MOUNTAIN5 = "mountain:5"
FEW, MANY = 32, 128
"""PEs between which figure 6 is judged."""
HALF = 0.5
TIME_BELOW, TIME_ABOVE = (1.5, 3.9), (1.0, 1.7)
"""Time profits that the paper's text gives below half of the scene, and from there on."""
MESSAGES_BELOW = (1.7, 6.1)
ACCELERATION = 2.2
WIDENED = 0.05
ALIKE = 0.8
"""Rank correlation of curves that count as similar."""
GAINING = (REFERENCE, CONCURRENT)


def f4a(evidence: Evidence) -> Verdict:
    """Every (scene, x < 1) within the band, widened by 5 %.

    The band: 3.9 to 1.5 for x < 50 %, 1.7 to 1 for x >= 50 %.
    """
    gains = partitioned(mean_profits(evidence.figure4, MAKESPAN))
    below = {at: value for at, value in gains.items() if at.x < HALF}
    above = {at: value for at, value in gains.items() if at.x >= HALF}
    return verdict(
        "F4a",
        "figure 4 (64 PEs): time profit of concurrent dataflow 3.9 to 1.5 for x < 50 %, 1.7 to 1 "
        "for x >= 50 %",
        f"{span(below.values())} for x < 50 %, {span(above.values())} for x >= 50 %",
        criteria(below, evidence.figure4, GAINING, *_widened(TIME_BELOW))
        + criteria(above, evidence.figure4, GAINING, *_widened(TIME_ABOVE)),
    )


def f4b(evidence: Evidence) -> Verdict:
    """Argmax over (scene, x) is mountain 5, value 3.5 to 4.2."""
    gains = mean_profits(evidence.figure4, MAKESPAN)
    best = largest_at(gains)
    own = largest(of_scene(gains, MOUNTAIN5).values())
    others = largest(value for at, value in gains.items() if at.scene != MOUNTAIN5)
    return verdict(
        "F4b",
        "figure 4 (64 PEs): the largest time profit is Mountain5's, nearly 4",
        f"{gains[best]:.3g} at {best}; {MOUNTAIN5}'s largest is {own:.3g}",
        [Criterion(f"{MOUNTAIN5}'s largest against the others'", own, low=others)],
        criteria({best: gains[best]}, evidence.figure4, GAINING, 3.5, 4.2),
    )


def f4c(evidence: Evidence) -> Verdict:
    """Pairwise rank correlation over X >= .8; every scene's best x <= .3."""
    gains = mean_profits(evidence.figure4, MAKESPAN)
    curves = {scene: of_scene(gains, scene) for scene in evidence.figure4.scenes}
    pairs = {
        f"{a} and {b}": rank_correlation(curves[a], curves[b]) for a, b in combinations(curves, 2)
    }
    best = {scene: largest_at(curve).x for scene, curve in curves.items()}
    return verdict(
        "F4c",
        "figure 4 (64 PEs): the curves of all scenes have very similar shapes, best at a low x",
        f"rank correlations {span(pairs.values())}; best x {span(best.values())}",
        [Criterion(pair, value, low=ALIKE) for pair, value in pairs.items()],
        [Criterion(f"{scene}'s best x", x, high=0.3) for scene, x in best.items()],
    )


def f4d(evidence: Evidence) -> Verdict:
    """Every scene: profit at its smallest x < its best, and >= 1.8."""
    gains = mean_profits(evidence.figure4, MAKESPAN)
    curves = [of_scene(gains, scene) for scene in evidence.figure4.scenes]
    lowest = {min(curve, key=lambda at: at.x): largest(curve.values()) for curve in curves}
    of_best = {at: gains[at] / best for at, best in lowest.items()}
    at_least = {at: gains[at] for at in lowest}
    return verdict(
        "F4d",
        "figure 4 (64 PEs): below 10 % time profits fall, but stay >= 1.8",
        f"at the smallest x: {span(at_least.values())}, which is {span(of_best.values())} of the "
        "scene's best",
        [
            Criterion(f"{at}, of the best", value, high=1, strict=True)
            for at, value in of_best.items()
        ],
        criteria(at_least, evidence.figure4, GAINING, low=1.8),
    )


def f5a(evidence: Evidence) -> Verdict:
    """Every (scene, x < .5) within the band widened by 5 %; rank correlation with its time
    profit >= .8.

    The band: 6.1 to 1.7. The correlation is that of the scene's two curves over X.
    """
    times, messages = (mean_profits(evidence.figure4, column) for column in (MAKESPAN, MESSAGES))
    below = {at: value for at, value in messages.items() if at.x < HALF}
    alike = {
        scene: rank_correlation(of_scene(times, scene), of_scene(messages, scene))
        for scene in evidence.figure4.scenes
    }
    return verdict(
        "F5a",
        "figure 5 (64 PEs): message profit 6.1 to 1.7 for x < 50 %; curves very similar to figure "
        "4's",
        f"{span(below.values())} for x < 50 %; rank correlations with the time profit "
        f"{span(alike.values())}",
        criteria(below, evidence.figure4, GAINING, *_widened(MESSAGES_BELOW)),
        [Criterion(f"{scene}'s two curves", value, low=ALIKE) for scene, value in alike.items()],
    )


def f6a(evidence: Evidence) -> Verdict:
    """T(32)/T(128) > 2.2 for concurrent at every x in X."""
    measured = evidence.figure6
    values = {x: mean(measured.acceleration(MOUNTAIN5, x, FEW, MANY)) for x in measured.fractions}
    return verdict(
        "F6a",
        "figure 6 (Mountain5): acceleration between 32 and 128 PEs > 2.2 at every fraction",
        f"T(32)/T(128) {span(values.values())}",
        [
            Criterion(
                f"x = {x:.4g}", value, ACCELERATION, strict=True, accounts=_scaling(measured, x)
            )
            for x, value in values.items()
        ],
    )


def t2(evidence: Evidence) -> Verdict:
    """No policy beats `replicated` at any (scene, x) of figure 4."""
    measured = evidence.figure4
    fastest = {at: _fastest(measured, at) for at in points(measured)}
    return verdict(
        "T2",
        "abstracts: no dataflow is the fastest",
        f"T(fastest policy)/T(replicated) {span(value for value, _ in fastest.values())}",
        [
            case
            for at, (value, policy) in fastest.items()
            for case in criteria({at: value}, measured, [policy], low=1)
        ],
    )


def _widened(band: tuple[float, float]) -> tuple[float, float]:
    return band[0] * (1 - WIDENED), band[1] * (1 + WIDENED)


def _fastest(measured: RowIndex, at: At) -> tuple[float, str]:
    """T(policy)/T(replicated) of the policy with the least, and its name; nan if one is missing."""
    replicated = CurvePoint(*at, REPLICATED)
    times = {
        policy: mean(measured.ratios(MAKESPAN, CurvePoint(*at, policy), replicated))
        for policy in (REFERENCE, RAY, CONCURRENT)
    }
    policy = list(times)[int(np.argmin([*times.values()]))]
    return times[policy], policy


def _scaling(measured: RowIndex, x: float) -> dict[str, dict[str, float]]:
    return {
        f"{nb} PEs": measured.accounts(CurvePoint(MOUNTAIN5, nb, x, CONCURRENT))
        for nb in (FEW, MANY)
    }
