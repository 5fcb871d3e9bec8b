"""The tree of boxes: each leaf once, inside all boxes above it, however near the boxes lie."""

from __future__ import annotations

import os
import subprocess
import sys

import numpy as np
import pytest

from simmpp.scene.scene import Camera, Material, Polygon, Scene
from simmpp.workload.check import check
from simmpp.workload.picture import Picture
from simmpp.workload.trace.bvh import EMPTY, build
from simmpp.workload.trace.tracer import trace


def leaves_below(boxes, bounds, children, node: int = 0) -> list[int]:
    found = []
    for k, child in enumerate(children[node]):
        if child == EMPTY:
            continue
        leaves = [~child] if child < 0 else leaves_below(boxes, bounds, children, child)
        assert (bounds[node, :3, k] == boxes[leaves, :3].min(axis=0)).all()
        assert (bounds[node, 3:, k] == boxes[leaves, 3:].max(axis=0)).all()
        found += leaves
    return found


@pytest.mark.parametrize("n", [1, 2, 8, 9, 100])
@pytest.mark.parametrize("apart", [0.0, 5e-324, 1e-310, 1e-307, 1.0, 1e300])
def test_every_box_is_one_leaf(n: int, apart: float) -> None:
    centres = np.random.default_rng(n).integers(0, n, (n, 3)) * apart
    boxes = np.hstack([centres, centres])
    tree, _ = build(boxes)
    assert sorted(leaves_below(boxes, *tree)) == list(range(n))


def test_trees_of_rows_follow_the_first() -> None:
    rows = np.random.default_rng(0).random((300, 3)).repeat(2, axis=0).reshape(300, 6)
    spans = np.array([(0, 9), (20, 21), (21, 300)])
    tree, roots = build(rows[:5], rows, spans)
    assert leaves_below(rows, *tree) == [0, 1, 2, 3, 4]
    for root, (first, after) in zip(roots, spans, strict=True):
        assert sorted(leaves_below(rows, *tree, root)) == list(range(first, after))


@pytest.mark.parametrize("n_pairs", [5, 12, 19, 100])
def test_there_is_room_for_the_most_nodes(n_pairs: int) -> None:
    """Each cut takes two boxes from the rest, as each lies far beyond the one before."""
    centres = np.zeros((n_pairs, 3))
    centres[:, 0] = 64.0 ** np.arange(n_pairs)
    boxes = np.hstack([centres, centres + 1]).repeat(2, axis=0)
    tree, _ = build(boxes)
    assert sorted(leaves_below(boxes, *tree)) == list(range(len(boxes)))
    # Eight nodes for each fourteen boxes, but for the last ones.
    assert 4 * (len(boxes) - 14) // 7 < len(tree.children) <= 4 * len(boxes) // 7 + 1


def test_no_bin_is_infinite_or_not_a_number() -> None:
    """Compiled, such a bin is a write beside an array, which may go unseen; Python refuses it."""
    build_subnormal = (
        "import numpy as np; from simmpp.workload.trace.bvh import build;"
        "build(np.repeat(np.arange(64)[:, None] * 1e-310, 6, axis=1))"
    )
    interpreted = os.environ | {"NUMBA_DISABLE_JIT": "1"}
    subprocess.run([sys.executable, "-c", build_subnormal], env=interpreted, check=True)


def test_a_scene_of_polygons_a_subnormal_number_apart() -> None:
    """The frame scales a scene to size one: a large object keeps the others as small as given."""
    square = np.array([[0.0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]])
    specks = [Polygon(square * k * 1e-310) for k in range(1, 65)]
    camera = Camera(eye=(0.5, 0.5, -4.0), at=(0.5, 0.5, 0.0), up=(0.0, 1.0, 0.0))
    scene = Scene("specks", (*specks, Polygon(square)), (Material(),), (), camera)
    workload = trace(scene, Picture(resolution=8))
    check(workload, "specks")
    assert set(workload.hits) == {-1, 64}
