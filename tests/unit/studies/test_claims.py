"""Each claim on rows made by hand: some where it holds, some where it holds in part or does not."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import Any

import pytest

from simmpp.studies.nebel98.claims import judge
from simmpp.studies.nebel98.evidence import Evidence
from simmpp.studies.nebel98.verdict import DOES_NOT, HOLDS, IN_PART, Verdict
from simmpp.sweeps.ratios import RowIndex

X = (1 / 64, 0.05, 0.1, 0.3, 0.5, 0.8, 0.9, 1.0)
SCENES = ("mountain:5", "rings:1", "tetra:5", "tetra:6")
OBJECT_PS, OBJECT_MESSAGES = 10**9, 10**6


def row(scene: str, nb: int, x: float, policy: str, time: float, messages: float) -> dict[str, Any]:
    return {
        "scene": scene,
        "processors": nb,
        "fraction": x,
        "policy": policy,
        "makespan_ps": round(time),
        "messages": round(messages),
        "compute_ps": 1,
        "communication_ps": 1,
        "waiting_ps": 2,
        "error": "",
    }


def both_seeds(rows: Iterable[dict[str, Any]]) -> list[dict[str, Any]]:
    """Two seeds, one of which is three times as slow: ratios must be the seed's own."""
    return [
        {**each, "seed": seed, "makespan_ps": round(each["makespan_ps"] * factor)}
        for each in rows
        for seed, factor in enumerate((1, 3))
    ]


def figure3(ratio: Callable[[int, float], float]) -> RowIndex:
    return RowIndex(
        both_seeds(
            row("tetra:5", nb, x, policy, OBJECT_PS * factor, 1)
            for nb in (8, 16, 32, 64, 128)
            for x in X
            for policy, factor in (("object", 1.0), ("ray", ratio(nb, x)))
        )
    )


def figure4(
    time: Callable[[str, float], float],
    message: Callable[[str, float], float] = lambda scene, x: 2,
    ray: float = 2.0,
    replicated: float = 0.01,
) -> RowIndex:
    rows = []
    for scene in SCENES:
        for x in X:
            sent = OBJECT_MESSAGES / message(scene, x)
            rows += [
                row(scene, 64, x, "object", OBJECT_PS, OBJECT_MESSAGES),
                row(scene, 64, x, "ray", OBJECT_PS * ray, 1),
                row(scene, 64, x, "concurrent", OBJECT_PS / time(scene, x), sent),
                row(scene, 64, x, "replicated", OBJECT_PS * replicated, 0),
            ]
    return RowIndex(both_seeds(rows))


def figure6(gain: Callable[[float], float]) -> RowIndex:
    return RowIndex(
        both_seeds(
            row("mountain:5", nb, x, "concurrent", OBJECT_PS / factor, 1)
            for x in X
            for nb, factor in ((32, 1.0), (64, 1.5), (128, gain(x)))
        )
    )


def papers_curve(scene: str, x: float) -> float:
    """Profits as the paper has them: Mountain5's nearly 4, all best at 10 %, falling to 1."""
    top = 3.9 if scene == "mountain:5" else 3.0
    if x < 0.1:
        return 1.9 + x
    return top if x == 0.1 else 1 + 0.9 * (1 - x)


def verdicts(
    three: RowIndex | None = None,
    four: RowIndex | None = None,
    six: RowIndex | None = None,
) -> dict[str, Verdict]:
    evidence = Evidence(
        three or figure3(lambda nb, x: (1.2 if x >= 0.8 else 0.9) + nb / 100),
        four or figure4(papers_curve, papers_curve),
        six or figure6(lambda x: 2.3),
    )
    return {each.claim: each for each in judge(evidence)}


CLAIMS = ("F3a", "F3b", "F3c", "F4a", "F4b", "F4c", "F4d", "F5a", "F6a", "T1", "T2")


def test_the_papers_own_curves_hold() -> None:
    found = verdicts()
    assert tuple(found) == CLAIMS
    assert {claim: each.holds for claim, each in found.items()} == dict.fromkeys(CLAIMS, HOLDS)


@pytest.mark.parametrize(
    ("claim", "expected", "rows"),
    [
        # strictly above 1, from 0.8 on and before 1
        ("F3a", DOES_NOT, {"three": figure3(lambda nb, x: 1)}),
        ("F3a", IN_PART, {"three": figure3(lambda nb, x: 1.1 if x == 0.8 else 0.9)}),
        ("F3a", HOLDS, {"three": figure3(lambda nb, x: 1.1 if 0.8 <= x < 1 else 0.5)}),
        # ray dataflow may win at 0.5, not above
        ("F3b", HOLDS, {"three": figure3(lambda nb, x: 0.9 if x <= 0.5 else 1)}),
        ("F3b", IN_PART, {"three": figure3(lambda nb, x: 0.9 if x <= 0.8 else 1)}),
        ("F3b", DOES_NOT, {"three": figure3(lambda nb, x: 0.9 if x > 0.3 else 1)}),
        ("F3b", HOLDS, {"three": figure3(lambda nb, x: 1.5)}),
        ("F3c", DOES_NOT, {"three": figure3(lambda nb, x: 1.5)}),
        ("F3c", DOES_NOT, {"three": figure3(lambda nb, x: nb / 200)}),
        ("F3c", HOLDS, {"three": figure3(lambda nb, x: nb / 100)}),
        # the widened bands: 1.425 to 4.095, and 0.95 to 1.785
        ("F4a", HOLDS, {"four": figure4(lambda s, x: 4.09 if x < 0.5 else 1.78)}),
        ("F4a", DOES_NOT, {"four": figure4(lambda s, x: 4.1 if x < 0.5 else 0.96)}),
        ("F4a", IN_PART, {"four": figure4(lambda s, x: 1.43 if x < 0.5 else 1.79)}),
        ("F4a", DOES_NOT, {"four": figure4(lambda s, x: 1.42 if x < 0.5 else 0.94)}),
        ("F4b", DOES_NOT, {"four": figure4(lambda s, x: 3.9 if s == "tetra:6" else 3.0)}),
        ("F4b", DOES_NOT, {"four": figure4(lambda s, x: 3.4 if s == "mountain:5" else 3.0)}),
        ("F4b", DOES_NOT, {"four": figure4(lambda s, x: 4.3 if s == "mountain:5" else 3.0)}),
        # one of four curves turned: half of the six pairs
        ("F4c", IN_PART, {"four": figure4(lambda s, x: 2 + x if s == "rings:1" else 3 - x)}),
        ("F4c", DOES_NOT, {"four": figure4(lambda s, x: 2 + x)}),
        ("F4c", HOLDS, {"four": figure4(lambda s, x: 3 - abs(x - 0.3))}),
        ("F4d", DOES_NOT, {"four": figure4(lambda s, x: 3 - x)}),
        ("F4d", DOES_NOT, {"four": figure4(lambda s, x: 1.7 + x)}),
        ("F4d", IN_PART, {"four": figure4(lambda s, x: (1.9 if s[0] == "t" else 1.5) + x)}),
        # within 1.615 to 6.405 below one half
        ("F5a", HOLDS, {"four": figure4(papers_curve, lambda s, x: papers_curve(s, x) + 2.5)}),
        ("F5a", DOES_NOT, {"four": figure4(papers_curve, lambda s, x: papers_curve(s, x) + 5)}),
        ("F5a", DOES_NOT, {"four": figure4(papers_curve, lambda s, x: 6 - papers_curve(s, x))}),
        (
            "F5a",
            IN_PART,
            {
                "four": figure4(
                    papers_curve,
                    lambda s, x: papers_curve(s, x) if s[0] == "t" else 6 - papers_curve(s, x),
                )
            },
        ),
        ("F6a", IN_PART, {"six": figure6(lambda x: 2.3 if x < 0.5 else 2.19)}),
        ("F6a", DOES_NOT, {"six": figure6(lambda x: 2.19)}),
        ("T1", DOES_NOT, {"four": figure4(papers_curve, ray=1.0)}),
        ("T1", HOLDS, {"four": figure4(papers_curve, ray=1.01)}),
        # only where concurrent dataflow is more than twice as fast as object dataflow: at 0.1
        ("T2", IN_PART, {"four": figure4(papers_curve, replicated=0.5)}),
        ("T2", DOES_NOT, {"four": figure4(papers_curve, replicated=0.9)}),
        ("T2", DOES_NOT, {"four": figure4(papers_curve, replicated=3)}),
    ],
)
def test_a_claim_follows_its_predicate(
    claim: str, expected: str, rows: dict[str, RowIndex]
) -> None:
    found = verdicts(**rows)[claim]
    assert found.holds == expected, found


def test_a_failed_point_makes_nothing_hold() -> None:
    rows = both_seeds(
        row("tetra:5", nb, x, policy, OBJECT_PS * factor, 1)
        for nb in (8, 16, 32, 64, 128)
        for x in X
        for policy, factor in (("object", 1.0), ("ray", 1 + nb))
    )
    for each in rows:
        if each["processors"] == 128 and each["fraction"] == 0.9:
            each["error"] = "timeout"
    found = verdicts(three=RowIndex(rows))
    assert found["F3a"].holds == IN_PART
    assert found["F3b"].holds == DOES_NOT  # whether ray dataflow wins there is not known
    assert found["F3c"].holds == DOES_NOT
