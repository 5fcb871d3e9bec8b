"""What Nebel 1998 says was measured, claim by claim, judged by what was simulated.

The predicate of each claim is the docstring of its function; all were fixed before anything was
simulated. Values are means over seeds, X is the grid of fractions x that is swept, and the four
scenes are Mountain5, Ring1, Tetrahedron5 and Tetrahedron6 (figure 4's rows).
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import combinations

from simmpp.report.measured import (
    CONCURRENT,
    MAKESPAN,
    MESSAGES,
    RAY,
    REPLICATED,
    Measured,
    Point,
    mean,
)
from simmpp.report.values import (
    At,
    Values,
    cases,
    largest,
    largest_at,
    of_scene,
    points,
    profits,
    rank_correlation,
    ray_over_object,
    span,
)
from simmpp.report.verdict import Case, Verdict, verdict
from simmpp.sweep.point import REFERENCE

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
CLASSICAL, GAINING = (REFERENCE, RAY), (REFERENCE, CONCURRENT)


@dataclass(frozen=True)
class Evidence:
    """The rows of the figures that claims are about."""

    figure3: Measured
    figure4: Measured
    figure6: Measured


def judge(evidence: Evidence) -> list[Verdict]:
    """The verdict on every claim about what is simulated, in the paper's order."""
    return [claim(evidence) for claim in (f3a, f3b, f3c, f4a, f4b, f4c, f4d, f5a, f6a, t1, t2)]


def f3a(evidence: Evidence) -> Verdict:
    """T(ray)/T(object) > 1 for x >= .8 (x < 1), each nb in 8, 16, 32, 64, 128."""
    ratios = ray_over_object(evidence.figure3)
    lightly = {at: value for at, value in ratios.items() if 0.8 <= at.x < 1}
    return verdict(
        "F3a",
        "figure 3 (Tetrahedron5): object dataflow best where the scene is lightly partitioned",
        f"T(ray)/T(object) {span(lightly.values())} at 0.8 <= x < 1",
        cases(lightly, evidence.figure3, CLASSICAL, above=1),
    )


def f3b(evidence: Evidence) -> Verdict:
    """Where the ratio is < 1, x <= .5."""
    ratios = ray_over_object(evidence.figure3)
    ray_wins = {at: at.x for at, value in ratios.items() if value < 1}
    ray_wins |= {at: math.nan for at, value in ratios.items() if math.isnan(value)}
    where = f", x {span(ray_wins.values())}" if ray_wins else ""
    return verdict(
        "F3b",
        "figure 3 (Tetrahedron5): ray dataflow may be best only where the scene is extensively "
        "partitioned",
        f"T(ray)/T(object) < 1 in {len(ray_wins)} of {len(ratios)} cases (x, nb){where}",
        cases(ray_wins, evidence.figure3, CLASSICAL, high=HALF),
    )


def f3c(evidence: Evidence) -> Verdict:
    """The mean ratio over X at nb = 128 is > 1 and above that at 8."""
    ratios = ray_over_object(evidence.figure3)
    few, many = (
        mean([value for at, value in ratios.items() if at.processors == nb]) for nb in (8, MANY)
    )
    return verdict(
        "F3c",
        "figure 3 (Tetrahedron5): object dataflow best where there are many processors",
        f"mean of T(ray)/T(object) over X: {many:.3g} at nb = {MANY}, {few:.3g} at nb = 8",
        [Case(f"mean at nb = {MANY}", many, low=1, strict=True)],
        [Case("the same against nb = 8", many, low=few, strict=True)],
    )


def f4a(evidence: Evidence) -> Verdict:
    """Every (scene, x < 1) within the band, widened by 5 %.

    The band: 3.9 to 1.5 for x < 50 %, 1.7 to 1 for x >= 50 %.
    """
    gains = _partitioned(profits(evidence.figure4, MAKESPAN))
    below = {at: value for at, value in gains.items() if at.x < HALF}
    above = {at: value for at, value in gains.items() if at.x >= HALF}
    return verdict(
        "F4a",
        "figure 4 (64 PEs): time profit of concurrent dataflow 3.9 to 1.5 for x < 50 %, 1.7 to 1 "
        "for x >= 50 %",
        f"{span(below.values())} for x < 50 %, {span(above.values())} for x >= 50 %",
        cases(below, evidence.figure4, GAINING, *_widened(TIME_BELOW))
        + cases(above, evidence.figure4, GAINING, *_widened(TIME_ABOVE)),
    )


def f4b(evidence: Evidence) -> Verdict:
    """Argmax over (scene, x) is mountain 5, value 3.5 to 4.2."""
    gains = profits(evidence.figure4, MAKESPAN)
    best = largest_at(gains)
    own = largest(of_scene(gains, MOUNTAIN5).values())
    others = largest(value for at, value in gains.items() if at.scene != MOUNTAIN5)
    return verdict(
        "F4b",
        "figure 4 (64 PEs): the largest time profit is Mountain5's, nearly 4",
        f"{gains[best]:.3g} at {best}; {MOUNTAIN5}'s largest is {own:.3g}",
        [Case(f"{MOUNTAIN5}'s largest against the others'", own, low=others)],
        cases({best: gains[best]}, evidence.figure4, GAINING, 3.5, 4.2),
    )


def f4c(evidence: Evidence) -> Verdict:
    """Pairwise rank correlation over X >= .8; every scene's best x <= .3."""
    gains = profits(evidence.figure4, MAKESPAN)
    curves = {scene: of_scene(gains, scene) for scene in evidence.figure4.scenes}
    pairs = {
        f"{a} and {b}": rank_correlation(curves[a], curves[b]) for a, b in combinations(curves, 2)
    }
    best = {scene: largest_at(curve).x for scene, curve in curves.items()}
    return verdict(
        "F4c",
        "figure 4 (64 PEs): the curves of all scenes have very similar shapes, best at a low x",
        f"rank correlations {span(pairs.values())}; best x {span(best.values())}",
        [Case(pair, value, low=ALIKE) for pair, value in pairs.items()],
        [Case(f"{scene}'s best x", x, high=0.3) for scene, x in best.items()],
    )


def f4d(evidence: Evidence) -> Verdict:
    """Every scene: profit at its smallest x < its best, and >= 1.8."""
    gains = profits(evidence.figure4, MAKESPAN)
    curves = [of_scene(gains, scene) for scene in evidence.figure4.scenes]
    lowest = {min(curve, key=lambda at: at.x): largest(curve.values()) for curve in curves}
    of_best = {at: gains[at] / best for at, best in lowest.items()}
    at_least = {at: gains[at] for at in lowest}
    return verdict(
        "F4d",
        "figure 4 (64 PEs): below 10 % time profits fall, but stay >= 1.8",
        f"at the smallest x: {span(at_least.values())}, which is {span(of_best.values())} of the "
        "scene's best",
        [Case(f"{at}, of the best", value, high=1, strict=True) for at, value in of_best.items()],
        cases(at_least, evidence.figure4, GAINING, low=1.8),
    )


def f5a(evidence: Evidence) -> Verdict:
    """Every (scene, x < .5) within the band widened by 5 %; rank correlation with its time
    profit >= .8.

    The band: 6.1 to 1.7. The correlation is that of the scene's two curves over X.
    """
    times, messages = (profits(evidence.figure4, column) for column in (MAKESPAN, MESSAGES))
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
        cases(below, evidence.figure4, GAINING, *_widened(MESSAGES_BELOW)),
        [Case(f"{scene}'s two curves", value, low=ALIKE) for scene, value in alike.items()],
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
            Case(f"x = {x:.4g}", value, ACCELERATION, strict=True, accounts=_scaling(measured, x))
            for x, value in values.items()
        ],
    )


def t1(evidence: Evidence) -> Verdict:
    """T(ray)/T(object) > 1 at 64 PEs for every (scene, x < 1)."""
    ratios = _partitioned(ray_over_object(evidence.figure4))
    return verdict(
        "T1",
        "section 4.2.2 (64 PEs): object dataflow is more efficient than ray dataflow",
        f"T(ray)/T(object) {span(ratios.values())}",
        cases(ratios, evidence.figure4, CLASSICAL, above=1),
    )


def t2(evidence: Evidence) -> Verdict:
    """No policy beats `replicated` at any (scene, x) of figure 4."""
    measured = evidence.figure4
    slower = {
        policy: {at: mean(_against_replicated(measured, at, policy)) for at in points(measured)}
        for policy in (REFERENCE, RAY, CONCURRENT)
    }
    values = [value for of_policy in slower.values() for value in of_policy.values()]
    return verdict(
        "T2",
        "abstracts: no dataflow is the fastest",
        f"T(policy)/T(replicated) {span(values)}",
        [case for name, each in slower.items() for case in cases(each, measured, [name], low=1)],
    )


def _partitioned(values: Values) -> Values:
    return {at: value for at, value in values.items() if at.x < 1}


def _widened(band: tuple[float, float]) -> tuple[float, float]:
    return band[0] * (1 - WIDENED), band[1] * (1 + WIDENED)


def _against_replicated(measured: Measured, at: At, policy: str) -> tuple[float, ...]:
    return measured.ratios(MAKESPAN, Point(*at, policy), Point(*at, REPLICATED))


def _scaling(measured: Measured, x: float) -> dict[str, dict[str, float]]:
    return {
        f"{nb} PEs": measured.accounts(Point(MOUNTAIN5, nb, x, CONCURRENT)) for nb in (FEW, MANY)
    }
