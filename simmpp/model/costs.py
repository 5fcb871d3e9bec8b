"""The paper's times of single operations (Nebel 1998, section 3.2), from a machine or as ratios."""

from __future__ import annotations

from dataclasses import dataclass, fields, replace

import numpy as np

from simmpp.common.errors import ConfigError
from simmpp.machine.machine import CopyCost, Machine
from simmpp.machine.messages import OBJECT, RAYS, REQUEST
from simmpp.machine.transfer import PS_PER_S, transfer_ps
from simmpp.model.known import require_known
from simmpp.workload.workload import Workload


@dataclass(frozen=True)
class Costs:
    """Times of single operations, in picoseconds or in any other unit: only ratios decide."""

    ray: float
    """T_ray: one step of a ray, which is one ray-object intersection."""
    sending: float
    """T_sending: startup of sending a message."""
    receipt: float
    """T_receipt: startup of receiving a message."""
    pack_request: float = 0
    unpack_request: float = 0
    pack_object: float = 0
    unpack_object: float = 0
    pack_ray: float = 0
    """Of one ray in a message of rays."""
    unpack_ray: float = 0
    deletion: float = 0
    """Set-up and shading of a ray, spent when it ends; the paper has no such term."""
    pack_message: float = 0
    """Packing a message of rays, however many; the paper has no such term."""
    unpack_message: float = 0

    def scaled(self, group: str, factor: float) -> Costs:
        """The same with one group of operations taking ``factor`` times as long.

        Raises ConfigError if there is no such group.
        """
        if group not in GROUPS:
            raise ConfigError(f"cost ratio {group!r}: expected one of {', '.join(GROUPS)}")
        return replace(self, **{name: factor * getattr(self, name) for name in GROUPS[group]})

    @property
    def startup(self) -> float:
        """T_sending + T_receipt."""
        return self.sending + self.receipt


GROUPS = {
    "startup": ("sending", "receipt"),
    "packing": tuple(field.name for field in fields(Costs) if "pack" in field.name),
    "object": ("pack_object", "unpack_object"),
    "test": ("ray", "deletion"),
}
"""Operations that a ratio scales together, by the name that the command takes."""


def costs_of(machine: Machine, workload: Workload) -> Costs:
    """The costs that a machine has for a workload.

    The model knows one size of object and one cost of a test: the means over the tests of the
    workload, which are exact where all objects are alike.

    Raises ConfigError off the torus, where the paper has one cost for a message to any PE, and
    where computing is uneven.
    """
    require_known(machine, workload)
    uses = np.bincount(workload.itinerary_objects, minlength=workload.n_objects)
    n_tests = max(int(uses.sum()), 1)
    object_bytes = float(uses @ workload.object_bytes.astype(np.float64)) / n_tests
    test_ps = float(uses @ machine.test.of_objects(workload, np.float64)) / n_tests
    pack, unpack = machine.pack, machine.unpack
    return Costs(
        ray=test_ps,
        sending=machine.send_startup_ps,
        receipt=machine.receive_startup_ps,
        pack_request=_copy(pack[REQUEST], machine.request_bytes),
        unpack_request=_copy(unpack[REQUEST], machine.request_bytes),
        pack_object=_copy(pack[OBJECT], object_bytes),
        unpack_object=_copy(unpack[OBJECT], object_bytes),
        pack_ray=_per_byte(pack[RAYS]) * machine.ray_bytes,
        unpack_ray=_per_byte(unpack[RAYS]) * machine.ray_bytes,
        deletion=machine.ray_ps,
        pack_message=pack[RAYS].fixed_ps,
        unpack_message=unpack[RAYS].fixed_ps,
    )


def _copy(cost: CopyCost, n_bytes: float) -> float:
    """The machine's own picoseconds for a whole number of bytes."""
    if n_bytes == int(n_bytes):
        return cost.fixed_ps + transfer_ps(int(n_bytes), cost.bytes_per_s)
    return cost.fixed_ps + _per_byte(cost) * n_bytes


def _per_byte(cost: CopyCost) -> float:
    return PS_PER_S / cost.bytes_per_s if cost.bytes_per_s else 0.0
