"""Accessors as arrays: typed, strided, sparse, normalised."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from simmpp.common.errors import SceneError
from simmpp.common.units import shown
from simmpp.scene.cut import Indices
from simmpp.scene.gltf.container import Buffers
from simmpp.scene.gltf.document import item
from simmpp.scene.gltf.schema import Accessor, Document, Sparse
from simmpp.scene.scene import Floats

COMPONENTS = {5120: "<i1", 5121: "<u1", 5122: "<i2", 5123: "<u2", 5125: "<u4", 5126: "<f4"}
UNSIGNED = (5121, 5123, 5125)
MOST_ZEROS = 1_000_000
"""Elements of an accessor that no bytes of the file stand for."""
WIDTHS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4}


class Arrays:
    """The accessors of a file as arrays, no larger than what its buffers hold."""

    def __init__(self, document: Document, buffers: Buffers) -> None:
        self._document, self._buffers = document, buffers

    def numbers(self, index: int, *types: str, normalized: bool = False) -> Floats:
        """An accessor of one of ``types``, (count, width); ``normalized`` or as it says itself.

        Normalised integers stand for -1 ... 1 or 0 ... 1.
        """
        accessor = self._accessor(index, types)
        values = self._values(accessor, f"accessors[{index}]")
        numbers = values.astype(np.float64)
        if values.dtype.kind == "f" or not (normalized or accessor.normalized):
            return numbers
        return np.maximum(numbers / np.iinfo(values.dtype).max, -1.0)

    def indices(self, index: int) -> Indices:
        """An accessor of unsigned integers, (count,) of the type that is stored."""
        accessor = self._accessor(index, ("SCALAR",))
        if accessor.component_type not in UNSIGNED:
            raise SceneError(f"accessors[{index}]: its indices are not unsigned integers")
        stored = self._values(accessor, f"accessors[{index}]").ravel()
        reserved = np.iinfo(stored.dtype).max
        if np.any(stored == reserved):
            raise SceneError(f"accessors[{index}]: the index {reserved} stands for no vertex")
        return stored

    def has_data(self, index: int) -> bool:
        """Whether the file holds numbers for an accessor; without, they are all 0."""
        accessor = item(self._document.accessors, index, "accessors")
        return accessor.buffer_view is not None or accessor.sparse is not None

    def _accessor(self, index: int, types: tuple[str, ...]) -> Accessor:
        accessor = item(self._document.accessors, index, "accessors")
        if accessor.type not in types:
            expected = " or ".join(types)
            problem = f"accessors[{index}].type: value {shown(accessor.type)}: expected {expected}"
            raise SceneError(problem)
        return accessor

    def _values(self, accessor: Accessor, name: str) -> NDArray[Any]:
        """(count, width), of the type that is stored."""
        width = WIDTHS[accessor.type]
        dtype = _component(accessor.component_type, name)
        if accessor.buffer_view is None:
            if accessor.count > MOST_ZEROS:
                problem = f"{name}: {accessor.count} elements without a bufferView"
                raise SceneError(f"{problem}, more than {MOST_ZEROS} zeros")
            values = np.zeros((accessor.count, width), dtype)
        else:
            data, stride = self._buffers.view(accessor.buffer_view)
            start, count = accessor.byte_offset, accessor.count
            values = _laid_out(data, start, stride, (count, width), dtype, name)
        if accessor.sparse is None:
            return values
        values = values.copy()
        places, changed = self._changes(accessor.sparse, accessor.count, width, dtype, name)
        values[places] = changed
        return values

    def _changes(
        self, sparse: Sparse, count: int, width: int, dtype: np.dtype[Any], name: str
    ) -> tuple[NDArray[Any], NDArray[Any]]:
        """Which elements are replaced, and by what."""
        if sparse.indices.component_type not in UNSIGNED:
            raise SceneError(f"{name}.sparse: its indices are not unsigned integers")
        kind = _component(sparse.indices.component_type, name)
        data, _ = self._buffers.view(sparse.indices.buffer_view)
        shape = (sparse.count, 1)
        places = _laid_out(data, sparse.indices.byte_offset, None, shape, kind, f"{name}.sparse")
        places = places.ravel().astype(np.int64)
        if np.any(np.diff(places) <= 0) or np.any(places >= count):
            raise SceneError(f"{name}.sparse: its indices don't ascend, or go beyond {count - 1}")
        data, _ = self._buffers.view(sparse.values.buffer_view)
        shape, start = (sparse.count, width), sparse.values.byte_offset
        return places, _laid_out(data, start, None, shape, dtype, f"{name}.sparse")


def _component(kind: int, name: str) -> np.dtype[Any]:
    if kind not in COMPONENTS:
        expected = ", ".join(map(str, COMPONENTS))
        raise SceneError(f"{name}.componentType: value {shown(kind)}: expected one of {expected}")
    return np.dtype(COMPONENTS[kind])


def _laid_out(
    data: memoryview,
    start: int,
    stride: int | None,
    shape: tuple[int, int],
    dtype: np.dtype[Any],
    name: str,
) -> NDArray[Any]:
    """``shape`` elements in ``data``, ``stride`` bytes from one to the next; nothing is copied."""
    count, width = shape
    size = width * dtype.itemsize
    stride = size if stride is None else stride
    if stride < size:
        raise SceneError(f"{name}: elements of {size} bytes, {stride} bytes apart")
    end = start + (count - 1) * stride + size
    if end > len(data):
        raise SceneError(f"{name} ends at byte {end} of its view, which has {len(data)}")
    return np.ndarray(shape, dtype, data, start, (stride, dtype.itemsize))
