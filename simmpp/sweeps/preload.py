"""Imported by the server that worker processes are forked from: they find all of this loaded."""

from __future__ import annotations

from simmpp.compiled import is_compiled
from simmpp.engine.simulate import DEFAULT_ENGINE
from simmpp.modules import ENGINE
from simmpp.sweeps.warm import warm_up
from simmpp.sweeps.worker import run_task as run_task

if is_compiled(ENGINE):  # else the workers compile, and can be interrupted
    warm_up(DEFAULT_ENGINE)
