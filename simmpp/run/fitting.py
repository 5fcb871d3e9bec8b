"""Which policies of a point fit into the memory of its PEs, and what each needs at least."""

from __future__ import annotations

from dataclasses import dataclass, replace

from simmpp.common.places import misplaced
from simmpp.common.units import format_bytes, shown, write_bytes
from simmpp.engine.capacity import Needs, capacity_bytes, lacking, needs_of
from simmpp.placement.rooms import LEAST, Capacity
from simmpp.policy.parameters import REFERENCE, PolicyParameters
from simmpp.run.point import Point, policies_of


@dataclass(frozen=True, eq=False)
class Fitting:
    """One policy at one point."""

    parameters: PolicyParameters
    named: bool
    """The configuration names it."""
    needs: Needs
    lacking_bytes: int
    """By how much the capacity is too small."""

    @property
    def fits(self) -> bool:
        """It can be run."""
        return self.lacking_bytes == 0


def fittings(point: Point) -> list[Fitting]:
    """What each policy needs; without a capacity all fit, and the least one is told."""
    bounds, workload = point.placement.capacity, point.workload
    placement = replace(point.placement, capacity=bounds or Capacity(LEAST))
    scene_bytes, found = int(workload.object_bytes.sum()), []
    for parameters, named in policies_of(point.config):
        needs = needs_of(workload, point.machine, placement, parameters)
        lacks = 0 if bounds is None else lacking(needs, placement, scene_bytes)
        found.append(Fitting(parameters, named, needs, lacks))
    return found


def require_fitting(point: Point) -> None:
    """Raise ConfigError if none of the named policies fits, or object dataflow doesn't."""
    bounds = point.placement.capacity
    if bounds is None:
        return
    found = fittings(point)
    missing = [each for each in found if each.parameters.name == REFERENCE and not each.fits]
    if not any(each.fits for each in found if each.named):
        missing = [each for each in found if each.named]
    if missing:
        best = min(missing, key=lambda each: each.needs.least_bytes)
        value = shown(write_bytes(capacity_bytes(bounds, best.needs)))
        least = f"at least {write_bytes(best.needs.least_bytes)} for {best.parameters.title}"
        problem = f"value {value}: expected {least}"
        raise misplaced(("memory", "capacity"), problem, point.config.places)


def told(point: Point) -> list[str]:
    """The least memory of each policy, and which do not fit."""
    found = fittings(point)
    needed = ", ".join(
        f"{each.parameters.title} {format_bytes(each.needs.least_bytes)}" for each in found
    )
    absent = [each.parameters.title for each in found if not each.fits]
    lines = [f"needs at least, per PE: {needed}"]
    if absent:
        lines.append(f"not run, as it does not fit into the capacity: {', '.join(absent)}")
    return lines
