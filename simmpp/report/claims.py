"""What Nebel 1998 says was measured, claim by claim, judged by what was simulated.

The predicate of each claim is the docstring of its function; all were fixed before anything was
simulated. Values are means over seeds, X is the grid of fractions x that is swept, and the four
scenes are Mountain5, Ring1, Tetrahedron5 and Tetrahedron6 (figure 4's rows).
"""

from __future__ import annotations

from simmpp.report.claims_classical import f3a, f3b, f3c, t1
from simmpp.report.claims_concurrent import f4a, f4b, f4c, f4d, f5a, f6a, t2
from simmpp.report.values import Evidence
from simmpp.report.verdict import Verdict

CLAIMS = (f3a, f3b, f3c, f4a, f4b, f4c, f4d, f5a, f6a, t1, t2)
"""In the paper's order; those about its model are judged with figure 2."""


def judge(evidence: Evidence) -> list[Verdict]:
    """The verdict on every claim about what is simulated."""
    return [claim(evidence) for claim in CLAIMS]
