"""Object, ray or concurrent dataflow? Ray tracing a partitioned scene on a simulated machine.

What the commands do, from Python::

    import simmpp

    scene = simmpp.load_scene("mountain:5")
    workload = simmpp.trace(scene, simmpp.Picture(resolution=128))
    machine = simmpp.make_machine("t3e", processors=64)
    placement = simmpp.place(workload, 64, simmpp.Memory(), simmpp.PlacementRules(), seed=0)
    result = simmpp.simulate(workload, machine, placement, simmpp.PolicyParameters("concurrent"))

Parts that are made one by one are as they say and know no reading: a machine has the constants of
its preset, and what ``Memory``, ``PlacementRules`` and ``PolicyParameters`` are not told has the
default of their fields. ``sweep`` takes a configuration, whose defaults are those of the reading
that it names, or of the default reading (``simmpp reading``).
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from simmpp.engine.result import Result
    from simmpp.engine.simulate import simulate
    from simmpp.machine.presets import machine as make_machine
    from simmpp.placement.place import place
    from simmpp.placement.placement import Cells, Memory, PlacementRules
    from simmpp.policy.parameters import PolicyParameters
    from simmpp.run.profit import profits
    from simmpp.studies.advise.advice import Advice
    from simmpp.studies.advise.advise import advise
    from simmpp.studies.curve.estimate import estimate
    from simmpp.sweeps.sweep import SweepResult
    from simmpp.sweeps.sweep import run_sweep as sweep
    from simmpp.workload.exchange.exchange import export_workload, import_workload
    from simmpp.workload.picture import Picture
    from simmpp.workload.sources import load_scene
    from simmpp.workload.trace.tracer import trace
else:  # type checkers would take any name to be there

    def __getattr__(name: str) -> Any:
        """Import on first use: ``simmpp --help`` must not wait for numba."""
        if name == "__version__":
            from importlib.metadata import version  # takes as long as all of simmpp --help

            return version("simmpp")
        if name not in _HOME:
            raise AttributeError(f"module 'simmpp' has no attribute '{name}'")
        module, _, attribute = _HOME[name].partition(":")
        value = getattr(import_module(module), attribute)
        globals()[name] = value
        return value


_HOME = {
    "Advice": "simmpp.studies.advise.advice:Advice",
    "Cells": "simmpp.placement.placement:Cells",
    "Memory": "simmpp.placement.placement:Memory",
    "Picture": "simmpp.workload.picture:Picture",
    "PlacementRules": "simmpp.placement.placement:PlacementRules",
    "PolicyParameters": "simmpp.policy.parameters:PolicyParameters",
    "Result": "simmpp.engine.result:Result",
    "SweepResult": "simmpp.sweeps.sweep:SweepResult",
    "advise": "simmpp.studies.advise.advise:advise",
    "estimate": "simmpp.studies.curve.estimate:estimate",
    "export_workload": "simmpp.workload.exchange.exchange:export_workload",
    "import_workload": "simmpp.workload.exchange.exchange:import_workload",
    "load_scene": "simmpp.workload.sources:load_scene",
    "make_machine": "simmpp.machine.presets:machine",
    "place": "simmpp.placement.place:place",
    "profits": "simmpp.run.profit:profits",
    "simulate": "simmpp.engine.simulate:simulate",
    "sweep": "simmpp.sweeps.sweep:run_sweep",
    "trace": "simmpp.workload.trace.tracer:trace",
}

__all__ = [
    "Advice",
    "Cells",
    "Memory",
    "Picture",
    "PlacementRules",
    "PolicyParameters",
    "Result",
    "SweepResult",
    "advise",
    "estimate",
    "export_workload",
    "import_workload",
    "load_scene",
    "make_machine",
    "place",
    "profits",
    "simulate",
    "sweep",
    "trace",
]


__version__: str


def __dir__() -> list[str]:
    """What there is for others, imported or not."""
    return sorted([*__all__, "__version__"])
