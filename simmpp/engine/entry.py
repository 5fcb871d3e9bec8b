"""Calling compiled functions from Python many times a second."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numba


def entry_point(function: Any, *arguments: Any) -> Callable[..., Any]:
    """The machine code of ``function`` for arguments of these types, callable from Python.

    numba's own dispatch works out the types of its arguments at every call, about a microsecond
    for the one record array that holds a state: as long as a short activity itself takes.
    Arguments of other types must never be passed.
    """
    signature = tuple(numba.typeof(argument) for argument in arguments)
    function.compile(signature)
    return function.overloads[signature].entry_point
