"""Modules that others name without importing them: whoever moves one changes it here."""

from __future__ import annotations

TRACER = "simmpp.workload.trace.tracer"
RADIOSITY = "simmpp.workload.radiosity.tracing"
CANDIDATES = "simmpp.workload.trace.itineraries"
PLACEMENT = "simmpp.placement.place"
METHODS = "simmpp.methods.table"
ENGINE = "simmpp.engine.compiled_engine"
PRELOAD = "simmpp.sweeps.preload"
PANELS = "simmpp.plot.matplotlib_panels"
PICTURES = "simmpp.report.run_figures.drawing"
NOTEBOOK = "simmpp.notebook"
COMPLETION = "simmpp.commands.parts.completion"
SERVED = "SIMMPP_SERVED"
"""What PRELOAD reads: the variable of the environment with the process that it is imported for."""

NAMED_MODULES = (
    *(TRACER, RADIOSITY, CANDIDATES, PLACEMENT, METHODS, ENGINE),
    *(PRELOAD, PANELS, PICTURES, NOTEBOOK, COMPLETION),
)
