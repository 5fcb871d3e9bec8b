"""Where the nodes of a scene are: trees of transformations, and copies of one mesh."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from simmpp.common.errors import SceneError
from simmpp.scene.gltf.accessors import Arrays
from simmpp.scene.gltf.document import item
from simmpp.scene.gltf.schema import Document, Instancing, Node
from simmpp.scene.scene import Floats

IDENTITY = np.eye(4)
STILL = (0.0, 0.0, 0.0)
UNTURNED = (0.0, 0.0, 0.0, 1.0)
UNSCALED = (1.0, 1.0, 1.0)


def worlds(document: Document) -> dict[int, Floats]:
    """The nodes of the scene that are seen, by index, with their (4, 4) transformations.

    The scene is the one that the file names, or its first, or all trees if there is no scene.
    """
    parents = _parents(document.nodes)
    local = _locals(document.nodes)
    found: dict[int, Floats] = {}
    waiting = [(root, IDENTITY) for root in _roots(document, parents)]
    while waiting:
        at, above = waiting.pop()
        node = document.nodes[at]
        if node.extensions.visibility.visible:
            if at in found:
                raise SceneError(f"nodes[{at}] is in its scene twice")
            found[at] = _product(above, local[at])
            waiting += [(child, found[at]) for child in node.children]
    return dict(sorted(found.items()))


def copies(world: Floats, node: Node, arrays: Arrays) -> list[Floats]:
    """The transformations of a node's mesh: its own, or one for each instance."""
    instancing = node.extensions.instancing
    return [world] if instancing is None else list(_product(world, _instances(instancing, arrays)))


def _instances(instancing: Instancing, arrays: Arrays) -> Floats:
    """(n, 4, 4) float64."""
    named = instancing.attributes
    columns = [
        arrays.numbers(named[name], kind, normalized=name == "ROTATION") if name in named else None
        for name, kind in (("TRANSLATION", "VEC3"), ("ROTATION", "VEC4"), ("SCALE", "VEC3"))
    ]
    counts = {len(column) for column in columns if column is not None}
    if len(counts) != 1:
        problem = "expected TRANSLATION, ROTATION and SCALE of one count, or some of them"
        raise SceneError(f"EXT_mesh_gpu_instancing: {problem}")
    (n,) = counts
    rest = (STILL, UNTURNED, UNSCALED)
    return _affine(
        *(
            np.tile(value, (n, 1)) if column is None else column
            for column, value in zip(columns, rest, strict=True)
        )
    )


def _parents(nodes: Sequence[Node]) -> dict[int, int]:
    """The node above each; raises SceneError unless they are trees."""
    parents: dict[int, int] = {}
    for above, node in enumerate(nodes):
        for child in node.children:
            item(nodes, child, "nodes")
            if child in parents:
                problem = f"a child of nodes[{parents[child]}] and of nodes[{above}]"
                raise SceneError(f"nodes[{child}] is {problem}: expected trees")
            parents[child] = above
    in_trees: set[int] = set()
    for start in parents:
        path: dict[int, None] = {}
        at: int | None = start
        while at is not None and at not in in_trees:
            if at in path:
                raise SceneError(f"nodes[{at}] is below itself: expected trees")
            path[at] = None
            at = parents.get(at)
        in_trees.update(path)
    return parents


def _roots(document: Document, parents: dict[int, int]) -> list[int]:
    if document.scene is None and not document.scenes:
        return [at for at in range(len(document.nodes)) if at not in parents]
    roots = item(document.scenes, document.scene or 0, "scenes").nodes
    for root in roots:
        item(document.nodes, root, "nodes")
        if root in parents:
            problem = f"a child of nodes[{parents[root]}]"
            raise SceneError(f"nodes[{root}] is a root of the scene, and {problem}")
    return roots


def _locals(nodes: Sequence[Node]) -> Floats:
    """The nodes' own transformations, (n, 4, 4)."""
    if not nodes:
        return np.zeros((0, 4, 4))
    local = _affine(
        np.array([node.translation or STILL for node in nodes]),
        np.array([node.rotation or UNTURNED for node in nodes]),
        np.array([node.scale or UNSCALED for node in nodes]),
    )
    for at, node in enumerate(nodes):
        if node.matrix is None:
            continue
        if any(part is not None for part in (node.translation, node.rotation, node.scale)):
            raise SceneError(f"nodes[{at}] has a matrix and also a translation, rotation or scale")
        local[at] = np.array(node.matrix).reshape(4, 4).T  # column by column in the file
        if local[at, 3].tolist() != [0, 0, 0, 1]:
            raise SceneError(f"nodes[{at}].matrix: expected the last row 0 0 0 1")
    return local


def _affine(translation: Floats, rotation: Floats, scale: Floats) -> Floats:
    """(n, 4, 4) float64: scaled, then turned by the quaternion (x, y, z, w), then moved."""
    norm = np.sqrt((rotation * rotation).sum(axis=1))
    if np.any(norm == 0):
        raise SceneError("a rotation is 0 0 0 0: expected a unit quaternion")
    x, y, z, w = (rotation / norm[:, None]).T
    turned = np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
            [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
            [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
        ]
    )
    matrices = np.tile(IDENTITY, (len(scale), 1, 1))
    matrices[:, :3, :3] = turned.transpose(2, 0, 1) * scale[:, None, :]
    matrices[:, :3, 3] = translation
    return matrices


def _product(a: Floats, b: Floats) -> Floats:
    """Matrices multiplied, with sums in a fixed order, which BLAS does not promise."""
    terms = [a[..., :, k, None] * b[..., k, None, :] for k in range(4)]
    return terms[0] + terms[1] + terms[2] + terms[3]
