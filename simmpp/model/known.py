"""What the paper's model knows of a machine."""

from __future__ import annotations

from simmpp.common.errors import ConfigError
from simmpp.machine.machine import Machine
from simmpp.machine.topology import require_torus


def require_known(machine: Machine) -> None:
    """Raise ConfigError for what the formulas have no term for."""
    require_torus(machine)
    if machine.is_uneven:
        problem = (
            "the paper's analytical model knows tests and rays of one cost on all PEs alone: "
            "expected no compute_startup, least_tests, speed, noise or straggler"
        )
        raise ConfigError(problem, where="machine")
