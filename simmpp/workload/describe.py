"""What a workload holds, in numbers: rays by kind, tests, and how much each object is used."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from simmpp.workload.workload import (
    FORM_FACTOR,
    OBJECT_KINDS,
    PARTICLE,
    PRIMARY,
    RAY_KINDS,
    Workload,
)

Fact = dict[str, int | float | str]


ROOTS_OF = {PARTICLE: "particles", FORM_FACTOR: "rays of patches"}
"""What roots are called that are no primary rays."""


def roots(workload: Workload) -> str:
    """``primary rays``, or what stands for them."""
    kind = int(workload.kinds[0]) if workload.n_rays else PRIMARY
    return ROOTS_OF.get(kind, "primary rays")


def is_picture(workload: Workload) -> bool:
    """Are its roots primary rays?"""
    return roots(workload) == "primary rays"


def primaries(workload: Workload) -> str:
    """``512 x 512 primary rays``, ``40000 particles``, ``9000 rays of patches in 9 rounds``."""
    rows, columns = workload.picture
    if not is_picture(workload):
        rounds = f" in {workload.n_rounds} rounds" if workload.n_rounds > 1 else ""
        return f"{workload.n_primaries} {roots(workload)}{rounds}"
    each = f"pixels with {workload.samples} " if workload.samples > 1 else ""
    return f"{columns} x {rows} {each}primary rays"


def rays_by_kind(workload: Workload) -> list[Fact]:
    """One row per kind of ray that occurs, and one for all."""
    lengths = np.diff(workload.itinerary_offsets)
    rows = [
        _row(name, lengths[workload.kinds == kind])
        for kind, name in enumerate(RAY_KINDS)
        if (workload.kinds == kind).any()
    ]
    return [*rows, _row("all", lengths)]


def _row(name: str, lengths: NDArray[np.int64]) -> Fact:
    return {
        "kind": name,
        "rays": len(lengths),
        "tests": int(lengths.sum()),
        "mean itinerary": round(float(lengths.mean()), 3) if len(lengths) else 0.0,
        "longest": int(lengths.max(initial=0)),
        "without tests": int((lengths == 0).sum()),
    }


def rays_by_depth(workload: Workload) -> list[int]:
    """Number of rays of depth 1, 2, ...; a generation lies behind the one that spawned it."""
    counts, first, last = [], 0, workload.n_primaries
    while first < last:
        counts.append(last - first)
        first, last = last, int(workload.child_offsets[last])
    return counts


def object_uses(workload: Workload, most: int | None = None) -> list[Fact]:
    """One row per object, the most tested first; only the first ``most`` if given."""
    tests = np.bincount(workload.itinerary_objects, minlength=workload.n_objects)
    own_cost = len(workload.object_test_ps) > 0
    return [
        {
            "object": int(n),
            "kind": OBJECT_KINDS[workload.object_kinds[n]],
            "bytes": int(workload.object_bytes[n]),
            "triangles": int(workload.object_triangles[n]),
            **({"test_ps": int(workload.object_test_ps[n])} if own_cost else {}),
            "tests": int(tests[n]),
        }
        for n in np.argsort(-tests, kind="stable")[:most]
    ]
