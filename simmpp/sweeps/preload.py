"""Imported by the server that worker processes are forked from: they find all of this loaded."""

from __future__ import annotations

from simmpp.common.compiled import is_compiled
from simmpp.common.modules import ENGINE
from simmpp.engine.simulate import DEFAULT_ENGINE
from simmpp.sweeps.worker import run_task as run_task
from simmpp.sweeps.worker import warm_up

if is_compiled(ENGINE):  # else the workers compile, and can be interrupted
    warm_up(DEFAULT_ENGINE)
