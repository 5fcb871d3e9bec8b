"""Cutting the triangles of a mesh into objects: the grain of everything that moves data.

All cuts depend on the order of the triangles and their positions alone. A square of two triangles
and a triangle apart, as an STL file stores them, with the corners of each triangle its own::

    vertices   a b c   a c d   e f g         faces  (0 1 2) (3 4 5) (6 7 8)
    welded     a b c d e f g                        (0 1 2) (0 2 3) (4 5 6)
    cut        nodes: [0 1 2]    components: [0 1] [2]    clusters of 1: [0] [1] [2]
    compacted  components: (a b c d; (0 1 2) (0 2 3))  (e f g; (0 1 2))

Without the welding every triangle of an STL file would be a component of its own.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from simmpp.common.errors import ConfigError
from simmpp.common.units import shown
from simmpp.scene.scene import Floats

OBJECTS = "nodes, components, groups or {clusters: 500} (triangles each at most)"
OF_OBJ = "groups"
"""Only this format has them."""
Indices = NDArray[np.integer[Any]]
"""Whole numbers of any width."""
Cut = Callable[[Floats, Indices], list[Indices]]
"""Vertices (n, 3) and faces (m, 3) -> the rows of ``faces`` in each object."""
FEW = 512
"""Parts of so many triangles are cut together: one by one, calls would take most of the time."""
ODD = np.array([0x9E3779B97F4A7C15, 0xBF58476D1CE4E5B9, 0x94D049BB133111EB], np.uint64)
"""Factors that spread neighbours apart. Source: S. Vigna, splitmix64."""
HALF = np.uint64(32)
Bits = NDArray[np.uint64]


def cut_named(objects: object) -> tuple[str, Cut]:
    """Label and cut for the configuration's ``objects``.

    ``nodes`` keeps a scene node whole, as ``groups`` does each group of a node of OBJ,
    ``components`` parts what no vertex joins, ``{clusters: k}`` bisects until no object has more
    than k triangles. Raises ConfigError, which says what was expected.
    """
    if objects in ("nodes", OF_OBJ):
        return str(objects), _whole
    if objects == "components":
        return "components", _components
    if isinstance(objects, Mapping) and set(objects) == {"clusters"}:
        most = objects["clusters"]
        if isinstance(most, int) and not isinstance(most, bool) and most >= 1:
            return str(most), lambda vertices, faces: _clusters(vertices, faces, most)
    raise ConfigError(f"value {shown(objects)}: expected {OBJECTS}")


def welded(vertices: Floats, faces: Indices) -> tuple[Floats, Indices]:
    """The mesh with equal positions made one vertex, in order of first use by a face.

    File formats repeat a vertex for each normal or texture coordinate; STL for each triangle.
    """
    corners = faces.ravel()
    kind = np.dtype(np.int32 if len(corners) < 2**31 else np.int64)
    same = _first_at_their_place(vertices)
    places = corners if same is None else same[corners].astype(kind)
    first: Indices = np.full(len(vertices), -1, kind)
    # From the last corner to the first, which is the one that stays.
    first[places[::-1]] = np.arange(len(places), dtype=kind)[::-1]
    used = np.flatnonzero(first >= 0)
    used = used[np.argsort(first[used])]
    number = first  # of each place, from here on
    kept = vertices[corners[first[used]]]
    number[used] = np.arange(len(used))
    return kept, number[places].reshape(faces.shape)


def _first_at_their_place(vertices: Floats) -> NDArray[np.int64] | None:
    """The first vertex (n,) that lies where each does; None if no two lie at one place.

    Places are told apart by a number for each: sorting these takes a tenth of the time of sorting
    places. Should two places get the same number, places are sorted after all.
    """
    bits = (vertices + 0.0).view(np.uint64)  # 0.0 and -0.0 are one position
    numbers = _numbers(bits)
    ordered = np.sort(numbers)
    if len(ordered) < 2 or np.all(ordered[1:] != ordered[:-1]):
        return None
    order = np.argsort(numbers)
    is_new, differs = _steps(numbers[order, None]), _steps(bits[order])
    if not np.array_equal(is_new, differs):
        order = np.lexsort(bits.T)
        is_new = _steps(bits[order])
    starts = np.flatnonzero(is_new)
    first = np.empty_like(order)
    first[order] = np.repeat(np.minimum.reduceat(order, starts), np.diff(starts, append=len(order)))
    return first


def _numbers(bits: Bits) -> Bits:
    """A number for each row (n, 3), the same for equal ones."""
    total = np.zeros(len(bits), np.uint64)
    for axis, factor in enumerate(ODD):
        total += bits[:, axis] * factor
        total ^= total >> HALF  # products carry upwards only
        total *= factor
    return total


def _steps(rows: Bits) -> NDArray[np.bool_]:
    """(n,) bool: which rows differ from those before them."""
    steps = np.ones(len(rows), dtype=np.bool_)
    steps[1:] = np.any(rows[1:] != rows[:-1], axis=1)
    return steps


def compacted(
    vertices: Floats, faces: Indices, parts: list[Indices]
) -> list[tuple[Floats, NDArray[np.int32]]]:
    """Of each part the vertices that its faces use, in order of index, and its faces into them."""
    if len(parts) == 1 and _are_all_used(vertices, faces):
        return [(vertices, faces[parts[0]].astype(np.int32, copy=False))]
    # One sort for all parts: a key is a vertex of one part, whichever others share it.
    sizes = np.array([len(rows) for rows in parts])
    part = np.repeat(np.arange(len(parts)), sizes)
    keys = part[:, None] * len(vertices) + faces[np.concatenate(parts)]
    used, inverse = np.unique(keys, return_inverse=True)
    starts = np.searchsorted(used, np.arange(1, len(parts)) * len(vertices))
    local = inverse.reshape(-1, 3) - np.append(0, starts)[part][:, None]
    return list(
        zip(
            np.split(vertices[used % len(vertices)], starts),
            np.split(local.astype(np.int32), np.cumsum(sizes)[:-1]),
            strict=True,
        )
    )


def _are_all_used(vertices: Floats, faces: Indices) -> bool:
    used = np.zeros(len(vertices), dtype=np.bool_)
    used[faces] = True
    return bool(used.all())


def _whole(_vertices: Floats, faces: Indices) -> list[Indices]:
    return [np.arange(len(faces))]


def _components(vertices: Floats, faces: Indices) -> list[Indices]:
    """Faces joined by shared vertices, in the order of each component's first face."""
    # Slow to import; only meshes need it.
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    # Two of its edges join a face's three vertices; the third would say it again.
    rows, columns = faces[:, [0, 1]].ravel(), faces[:, [1, 2]].ravel()
    n = len(vertices)
    links = coo_array((np.ones(len(rows), dtype=np.int8), (rows, columns)), shape=(n, n))
    n_labels, labels = connected_components(links, directed=False)
    if n_labels == 1:
        return _whole(vertices, faces)
    label = labels[faces[:, 0]]
    first = np.full(n_labels, len(faces))
    first[label[::-1]] = np.arange(len(faces))[::-1]
    rank = np.argsort(np.argsort(first))[label]
    order = np.argsort(rank, kind="stable")
    return np.split(order, np.flatnonzero(np.diff(rank[order])) + 1)


def _clusters(vertices: Floats, faces: Indices, most: int) -> list[Indices]:
    """Recursive bisection of the triangles' centroids on their longest axis.

    Ties between axes: x before y before z; between triangles: their order. Counts split
    floor(n / 2) : rest.
    """
    # From the least coordinates: where the mesh lies leaves the roundings as they are.
    centroids = (vertices - vertices.min(axis=0))[faces].sum(axis=1) / 3
    done: list[Indices] = []
    waiting = [np.arange(len(faces))]
    while waiting:
        part = waiting.pop()
        if len(part) <= max(most, FEW):
            done.append(part)
            continue
        points = centroids[part]
        axis = int(np.argmax(points.max(axis=0) - points.min(axis=0)))
        part = part[np.argsort(points[:, axis], kind="stable")]
        half = len(part) // 2
        waiting += [part[half:], part[:half]]
    return _clusters_of_all(centroids, done, most)


def _clusters_of_all(centroids: Floats, parts: list[Indices], most: int) -> list[Indices]:
    """The same of many small parts, all of them bisected at once."""
    order, sizes = np.concatenate(parts), np.array([len(part) for part in parts])
    while True:
        starts = np.cumsum(sizes) - sizes
        part = np.repeat(np.arange(len(sizes)), sizes)
        large = sizes > most
        if not large.any():
            order = order[np.lexsort((order, part))]
            return np.split(order, starts[1:])
        points = centroids[order]
        spread = np.maximum.reduceat(points, starts) - np.minimum.reduceat(points, starts)
        axis = np.argmax(spread, axis=1)[part]
        along = np.take_along_axis(points, axis[:, None], axis=1)[:, 0]
        along[~large[part]] = 0.0  # stays as it is
        order = order[np.lexsort((along, part))]
        lower = np.where(large, sizes // 2, 0)
        sizes = np.stack([lower, sizes - lower], axis=1).ravel()
        sizes = sizes[sizes > 0]
