"""Who owns an object, who else holds a replica of it, and who starts with which pixel."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from typing import Annotated, Any, Literal

import numpy as np
from numpy.typing import NDArray
from pydantic import SerializerFunctionWrapHandler, model_serializer, model_validator

from simmpp.common.quantities import Share, Size
from simmpp.common.strict import declared, integer, mistake
from simmpp.common.validate import MOST_COUNT

# --- cutting a row of things into near-equal parts ---


def cut(n: int, parts: int) -> NDArray[np.int32]:
    """The part of each of n things in a row, cut at floor(i n / parts): (n,) int32."""
    cuts = np.arange(parts + 1, dtype=np.int64) * n // parts
    return np.repeat(np.arange(parts, dtype=np.int32), np.diff(cuts))


Owners = Literal["bisection", "morton", "round_robin", "random"]
Residents = Literal["random", "nearest", "hot"]
Pixels = Literal["blocks", "tiles", "interleaved", "random"]


@declared
class Memory:
    """What fits into the memory of one PE."""

    fraction: Share = Fraction(1, 10)
    """Share x of all N objects that is resident on each PE: max(own, floor(x N + 1/2)) objects."""
    bytes: Size | None = None
    """The other way to say it: room for resident objects, in place of the fraction."""
    residents: Residents = "random"
    """Which objects are resident besides a PE's own."""
    transient: Annotated[int, *integer(0, MOST_COUNT, "objects")] = 0
    """Fetched objects kept besides the resident ones (least recently used leaves)."""

    @model_validator(mode="before")
    @classmethod
    def _one_size(cls, given: object) -> object:
        """Of what users write; Python's ``replace`` always passes both."""
        if isinstance(given, dict) and "fraction" in given and given.get("bytes") is not None:
            raise mistake("expected fraction or bytes, got both")
        return given

    @model_serializer(mode="wrap")
    def _as_written(self, handler: SerializerFunctionWrapHandler) -> dict[str, Any]:
        plain: dict[str, Any] = handler(self)
        if self.bytes is not None:
            del plain["fraction"]
        return plain


@declared
class PlacementRules:
    """How owners and pixels are chosen."""

    owners: Owners = "bisection"
    """How objects are dealt to their owners."""
    pixels: Pixels = "blocks"
    """How pixels are dealt to the PEs that start them."""


@dataclass(frozen=True, eq=False)
class Placement:
    """One draw of owners, residents and pixels for a number of PEs."""

    processors: int
    owners: NDArray[np.int32]
    """(N,) int32: the PE that owns each object."""
    replica_offsets: NDArray[np.int64]
    """(nb + 1,) int64: PE k holds replicas of
    replica_objects[replica_offsets[k]:replica_offsets[k + 1]] besides the objects it owns."""
    replica_objects: NDArray[np.int32]
    """(replicas,) int32 object ids."""
    transient: int
    """Number of fetched objects that a PE's transient memory holds."""
    pixel_pes: NDArray[np.int32]
    """(n0,) int32: the PE that each primary ray starts on."""

    @property
    def effective_fraction(self) -> float:
        """Mean number of resident objects of a PE / number of objects (1 for an empty scene)."""
        n_objects = len(self.owners)
        if n_objects == 0:
            return 1.0
        return (n_objects + len(self.replica_objects)) / (self.processors * n_objects)
