"""Rays of the SPD's default scenes as published, and as traced here.

Both tables are distributed with the SPD: Haines' README (1987) and the statistics of Havran and
Sixta (1999): 513 x 513 corner samples, depth 5. Haines' camera spanned 512/511 of the angle, which
costs his counts 0.3 %. He has no lattice; the teapot of both has no generator here.
"""

from __future__ import annotations

import numpy as np

from simmpp.workload.picture import Picture
from simmpp.workload.sources import load_scene
from simmpp.workload.trace.tracer import trace
from simmpp.workload.workload import PRIMARY, SHADOW

QUANTITIES = ("primary hits", "shadow rays", "blocked", "secondary rays", "secondary hits")
HAVRAN = {
    "balls:4": (263169, 959244, 285178, 179884, 134368),
    "gears:4": (245332, 2088012, 1057557, 494338, 365338),
    "mountain:6": (173685, 361037, 74555, 710436, 472351),
    "rings:7": (263169, 1077336, 510719, 312879, 175688),
    "tetra:6": (49950, 46262, 5538, 0, 0),
    "tree:11": (169907, 1110323, 47506, 0, 0),
    "lattice:12": (261170, 1180774, 943159, 243210, 178786),
}
HAINES = {
    "balls:4": (263169, 954368, None, 175095, None),
    "gears:4": (245086, 2246955, None, 304643 + 207564, None),
    "mountain:6": (173125, 412922, None, 2 * 354769, None),
    "rings:7": (263169, 1085002, None, 315236, None),
    "tetra:6": (49788, 46112, None, 0, None),
    "tree:11": (169836, 1097419, None, 0, None),
}


def traced_counts(name: str, max_depth: int = 5) -> tuple[int, ...]:
    """The QUANTITIES of a scene as traced here."""
    workload = trace(load_scene(name), Picture(samples="corners", max_depth=max_depth))
    rays = np.bincount(workload.kinds, minlength=4)
    hits = np.bincount(workload.kinds[workload.hits >= 0], minlength=4)
    counts = (hits[PRIMARY], rays[SHADOW], hits[SHADOW], rays[1:3].sum(), hits[1:3].sum())
    return tuple(int(count) for count in counts)


def off(name: str, quantity: str, count: int) -> float:
    """How far outside the range of the published numbers, relative to the nearer one."""
    column = QUANTITIES.index(quantity)
    tables = (HAVRAN, HAINES)
    published = [table[name][column] for table in tables if name in table]
    known = [number for number in published if number is not None]
    low, high = min(known), max(known)
    if low <= count <= high:
        return 0.0
    nearer = low if count < low else high
    return (count - nearer) / max(nearer, 1)
