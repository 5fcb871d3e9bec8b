"""Claims about the two classical dataflows: figure 3 of Nebel 1998, and section 4.2.2."""

from __future__ import annotations

import math

from simmpp.report.measured import RAY, mean
from simmpp.report.values import Evidence, cases, partitioned, ray_over_object, span
from simmpp.report.verdict import Case, Verdict, verdict
from simmpp.sweeps.point import REFERENCE

CLASSICAL = (REFERENCE, RAY)
FEW, MANY = 8, 128
"""PEs between which F3c compares."""
EXTENSIVELY = 0.5
"""The largest x that counts as "extensively partitioned"."""


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
        cases(ray_wins, evidence.figure3, CLASSICAL, high=EXTENSIVELY),
    )


def f3c(evidence: Evidence) -> Verdict:
    """The mean ratio over X at nb = 128 is > 1 and above that at 8."""
    ratios = ray_over_object(evidence.figure3)
    few, many = (
        mean([value for at, value in ratios.items() if at.processors == nb]) for nb in (FEW, MANY)
    )
    return verdict(
        "F3c",
        "figure 3 (Tetrahedron5): object dataflow best where there are many processors",
        f"mean of T(ray)/T(object) over X: {many:.3g} at nb = {MANY}, {few:.3g} at nb = {FEW}",
        [Case(f"mean at nb = {MANY}", many, low=1, strict=True)],
        [Case(f"the same against nb = {FEW}", many, low=few, strict=True)],
    )


def t1(evidence: Evidence) -> Verdict:
    """T(ray)/T(object) > 1 at 64 PEs for every (scene, x < 1)."""
    ratios = partitioned(ray_over_object(evidence.figure4))
    return verdict(
        "T1",
        "section 4.2.2 (64 PEs): object dataflow is more efficient than ray dataflow",
        f"T(ray)/T(object) {span(ratios.values())}",
        cases(ratios, evidence.figure4, CLASSICAL, above=1),
    )
