"""Modules that others name without importing them: whoever moves one changes it here."""

from __future__ import annotations

TRACER = "simmpp.workload.tracer"
CANDIDATES = "simmpp.workload.candidates"
PLACEMENT = "simmpp.placement.place"
METHODS = "simmpp.sweeps.methods"
ENGINE = "simmpp.engine.compiled_engine"
STEP = "simmpp.engine.activities"
PRELOAD = "simmpp.sweeps.preload"

NAMED_MODULES = (TRACER, CANDIDATES, PLACEMENT, METHODS, ENGINE, STEP, PRELOAD)
