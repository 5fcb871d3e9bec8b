"""Exceptions in hooks: compiled code can't pass them on, and goes on with the answer 0.

Python is told of such an exception at the moment when it is raised (``sys.unraisablehook``), but
not where. What the hook was shown is still there then: asked again as plain Python it raises the
exception anew, and that says the line.
"""

from __future__ import annotations

import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import numpy as np
from numpy.typing import NDArray

from simmpp.common.errors import ConfigError, ModelError
from simmpp.engine.state import State
from simmpp.policy.hooks import address_of
from simmpp.policy.mistakes import file_of, line_in
from simmpp.policy.parameters import PolicyParameters
from simmpp.policy.plain import plain_view, uncompiled
from simmpp.policy.policy import HOOKS, Hook
from simmpp.policy.view import View

Raised = tuple[BaseException, NDArray[np.void]]
"""An exception, and the views of then."""
_runs: dict[int, tuple[State, list[Raised]]] = {}
"""The run of each thread that runs a policy, and what its hooks raised."""
_others: list[Any] = []


def nothing(v: View) -> int:
    """What takes the place of a policy's hooks when one has raised: the run is to end soon."""
    return 0


OURS = "<numba.core.", "ctypes callback"
"""What Python says where a compiled or a plain hook raised, and not something else's finaliser."""


@contextmanager
def told_of_hooks(policy: PolicyParameters, state: State) -> Iterator[None]:
    """While a run is on, note what its hooks raise.

    Raises ConfigError for the first, with file and line, when the run is over or has starved.
    """
    me, raised = threading.get_ident(), list[Raised]()
    if sys.unraisablehook is not _note:
        _others.append(sys.unraisablehook)
        sys.unraisablehook = _note
    _runs[me] = state, raised
    try:
        yield
    except ModelError:
        if not raised:
            raise
    finally:
        del _runs[me]
    if raised:
        raise _explained(policy, *raised[0])


def _note(unraisable: Any) -> None:
    """Python calls this for an exception that nothing can catch."""
    run = _runs.get(threading.get_ident())
    if run is None or not any(text in f"{unraisable.object} {unraisable.err_msg}" for text in OURS):
        (_others[-1] if _others else sys.__unraisablehook__)(unraisable)
        return
    state, raised = run
    if not raised:
        error = unraisable.exc_value or unraisable.exc_type()
        raised.append((error, state.arrays["policy_views"].copy()))
        for hook in HOOKS:
            if state[hook]:
                state.runs[hook] = address_of(nothing)


def _explained(
    policy: PolicyParameters, error: BaseException, views: NDArray[np.void]
) -> ConfigError:
    """The line for an exception: of the first hook that raises one when it is shown the same."""
    names = tuple(policy.rules.parameters)
    for hook in policy.rules.hooks.values():
        for view in views:
            try:
                uncompiled(hook)(plain_view(view, names))
            except Exception as again:
                return _said(again, hook, line_in(hook.__code__.co_filename, again))
    return _said(error, next(iter(policy.rules.hooks.values())), None)


def _said(error: BaseException, hook: Hook, line: int | None) -> ConfigError:
    text = " ".join(str(error).split())
    problem = f"{hook.__name__}: {type(error).__name__}: {text}"
    return ConfigError(problem, where=file_of(hook), line=line)
