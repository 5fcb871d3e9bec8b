"""What Nebel 1998 says was measured, claim by claim, judged by what was simulated.

The predicate of each claim is the docstring of its function; all were fixed before anything was
simulated. Values are means over seeds, X is the grid of fractions x that is swept, and the four
scenes are Mountain5, Ring1, Tetrahedron5 and Tetrahedron6 (figure 4's rows). Here are those about
the two classical dataflows, figure 3 and section 4.2.2.
"""

from __future__ import annotations

import math

from simmpp.policy.parameters import REFERENCE
from simmpp.studies.nebel98.claims_concurrent import f4a, f4b, f4c, f4d, f5a, f6a, t2
from simmpp.studies.nebel98.evidence import Evidence, criteria, partitioned, ray_over_object, span
from simmpp.studies.nebel98.verdict import Criterion, Verdict, verdict
from simmpp.sweeps.ratios import RAY, mean

CLASSICAL = (REFERENCE, RAY)
F3C_PES = (8, 128)
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
        criteria(lightly, evidence.figure3, CLASSICAL, low=1, strict=True),
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
        criteria(ray_wins, evidence.figure3, CLASSICAL, high=EXTENSIVELY),
    )


def f3c(evidence: Evidence) -> Verdict:
    """The mean ratio over X at nb = 128 is > 1 and above that at 8."""
    ratios = ray_over_object(evidence.figure3)
    fewest, most = F3C_PES
    few, many = (
        mean([value for at, value in ratios.items() if at.processors == nb]) for nb in F3C_PES
    )
    return verdict(
        "F3c",
        "figure 3 (Tetrahedron5): object dataflow best where there are many processors",
        f"mean of T(ray)/T(object) over X: {many:.3g} at nb = {most}, {few:.3g} at nb = {fewest}",
        [Criterion(f"mean at nb = {most}", many, low=1, strict=True)],
        [Criterion(f"the same against nb = {fewest}", many, low=few, strict=True)],
    )


def t1(evidence: Evidence) -> Verdict:
    """T(ray)/T(object) > 1 at 64 PEs for every (scene, x < 1)."""
    ratios = partitioned(ray_over_object(evidence.figure4))
    return verdict(
        "T1",
        "section 4.2.2 (64 PEs): object dataflow is more efficient than ray dataflow",
        f"T(ray)/T(object) {span(ratios.values())}",
        criteria(ratios, evidence.figure4, CLASSICAL, low=1, strict=True),
    )


PREDICATES = (f3a, f3b, f3c, f4a, f4b, f4c, f4d, f5a, f6a, t1, t2)
"""In the paper's order; those about its model are judged with figure 2."""


def judge(evidence: Evidence) -> list[Verdict]:
    """The verdict on every claim about what is simulated."""
    return [claim(evidence) for claim in PREDICATES]
