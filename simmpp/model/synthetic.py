"""The workload that the analytical model assumes: every object is as likely as any other."""

from __future__ import annotations

import hashlib
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from simmpp.common.errors import ConfigError
from simmpp.common.randomness import generator
from simmpp.workload.workload import PRIMARY, SPHERE, Workload, frozen

Lives = Literal["fixed", "geometric"]
LIVES: tuple[Lives, ...] = ("fixed", "geometric")
OBJECT_BYTES = 256
"""Twice a ray: the model assumes that an object is bigger than a ray (Nebel 1998, section 3.1)."""


def synthetic(
    rays: int,
    steps: int,
    objects: int,
    *,
    lives: Lives = "fixed",
    object_bytes: int = OBJECT_BYTES,
    seed: int = 0,
) -> Workload:
    """``rays`` primary rays that need ``steps`` tests each, the object of each drawn at random.

    Every test is of one of ``objects`` objects of ``object_bytes``, all equally probable and drawn
    independently, so a ray may meet an object again. With ``lives`` geometric a ray ends after
    each test with probability 1 / ``steps``; ``steps`` is then the mean. Source: the assumptions
    of Nebel 1998, section 3.1.

    Raises ConfigError unless all numbers are positive.
    """
    for name, value in {"rays": rays, "steps": steps, "objects": objects}.items():
        if value < 1:
            raise ConfigError(f"synthetic workload: {name} {value}: expected 1 or more")
    if lives not in LIVES or object_bytes < 0:
        raise ConfigError(f"synthetic workload: expected lives {' or '.join(LIVES)}, bytes >= 0")
    lengths = _lengths(rays, steps, lives, seed)
    offsets = np.concatenate([[0], np.cumsum(lengths)]).astype(np.int64)
    drawn = generator(seed, "synthetic itineraries").integers(0, objects, offsets[-1], np.int32)
    made_of = repr((rays, steps, objects, lives, object_bytes, seed))
    return frozen(
        Workload(
            name=f"synthetic {rays} x {steps} of {objects}",
            digest=hashlib.sha256(f"synthetic {made_of}".encode()).hexdigest(),
            picture=(1, rays),
            kinds=np.full(rays, PRIMARY, np.uint8),
            parents=np.full(rays, -1, np.int32),
            child_offsets=np.full(rays + 1, rays, np.int32),
            pixels=np.arange(rays, dtype=np.int32),
            hits=drawn[offsets[1:] - 1],
            hit_distances=np.ones(rays),
            itinerary_offsets=offsets,
            itinerary_objects=drawn,
            object_kinds=np.full(objects, SPHERE, np.uint8),
            object_triangles=np.zeros(objects, np.int32),
            object_bytes=np.full(objects, object_bytes, np.int64),
            object_centroids=np.arange(objects)[:, np.newaxis] * np.array([1.0, 0.0, 0.0]),
        )
    )


def _lengths(rays: int, steps: int, lives: Lives, seed: int) -> NDArray[np.int64]:
    if lives == "fixed":
        return np.full(rays, steps, np.int64)
    return generator(seed, "synthetic lives").geometric(1.0 / steps, rays)
