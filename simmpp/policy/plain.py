"""Hooks as plain Python, called by address as compiled ones are: slow, and told apart by nothing.

What compiled code makes of a hook is checked against this: whole numbers that outgrow 64 bits,
indices beyond the end and divisions by zero are errors here, and exceptions have a line.
"""

from __future__ import annotations

import ctypes
from functools import partial
from types import CellType, FunctionType, SimpleNamespace
from typing import Any

import numpy as np

from simmpp.policy.policy import Hook
from simmpp.policy.record import VIEW
from simmpp.policy.view import View

WRITTEN = ("memory", "other", "words")
"""Fields that a hook may write."""
_CALLBACK = ctypes.CFUNCTYPE(ctypes.c_int64, ctypes.c_void_p)


class PlainHooks:
    """Keeps what stands behind the addresses that it gives out."""

    def __init__(self) -> None:
        self._kept: list[Any] = []
        self.answered_bool: set[Hook] = set()
        """Names of hooks that said true or false where others count."""

    def address_of(self, hook: Hook | None, parameters: tuple[str, ...] = ()) -> int:
        """Where a hook can be called; 0 for one that the policy does not have."""
        if hook is None:
            return 0
        callback = _CALLBACK(partial(self._answer, hook, uncompiled(hook), parameters))
        self._kept.append(callback)
        return int(ctypes.cast(callback, ctypes.c_void_p).value or 0)

    def _answer(self, hook: Hook, plain: Hook, parameters: tuple[str, ...], address: int) -> int:
        """What the hook says, and writes."""
        words = (ctypes.c_int64 * (VIEW.itemsize // 8)).from_address(address)
        record: Any = np.frombuffer(words, VIEW)  # type: ignore[call-overload]
        view = plain_view(record[0], parameters)
        answer = plain(view)
        if isinstance(answer, bool):
            self.answered_bool.add(hook)
        for name in WRITTEN:
            record[name] = getattr(view, name)
        return int(answer)


def uncompiled(hook: Hook) -> Hook:
    """The hook with the functions of numba that it calls as plain Python, which they are, too."""
    plain: dict[Any, Any] = {}

    def copy_of(function: Any) -> Any:
        function = getattr(function, "py_func", function)
        if function not in plain:
            cells = tuple(CellType() for _ in function.__closure__ or ())
            names: dict[str, Any] = {}
            code, defaults = function.__code__, function.__defaults__
            plain[function] = FunctionType(code, names, function.__name__, defaults, cells)
            names |= {name: called(value) for name, value in function.__globals__.items()}
            for cell, of_function in zip(cells, function.__closure__ or (), strict=True):
                cell.cell_contents = called(of_function.cell_contents)
        return plain[function]

    def called(value: Any) -> Any:
        return copy_of(value) if hasattr(value, "py_func") else value

    return copy_of(hook) if isinstance(hook, FunctionType) else hook


def plain_view(record: np.void, parameters: tuple[str, ...]) -> View:
    """A view in memory as plain Python has it."""
    values: dict[str, Any] = {name: record[name].tolist() for name in View.__annotations__}
    own = dict(zip(parameters, values["parameter"], strict=False))
    return SimpleNamespace(**own, **values)  # type: ignore[return-value]
