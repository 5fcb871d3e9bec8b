"""What the paper's model knows of a machine, and of rays."""

from __future__ import annotations

from simmpp.common.errors import ConfigError, WorkloadError
from simmpp.machine.machine import Machine
from simmpp.machine.topology import require_torus
from simmpp.workload.workload import Workload


def require_known(machine: Machine, workload: Workload) -> None:
    """Raise ConfigError or WorkloadError for what the formulas have no term for."""
    require_torus(machine)
    if machine.is_uneven:
        problem = (
            "the paper's analytical model knows tests and rays of one cost on all PEs alone: "
            "expected no compute_startup, least_tests, speed, noise or straggler"
        )
        raise ConfigError(problem, where="machine")
    for name in ("root_rounds", "ray_test_scales", "object_results"):
        if len(getattr(workload, name)):
            problem = f"the paper's analytical model has no term for {name}: expected simulate"
            raise WorkloadError(problem, where=workload.name)
