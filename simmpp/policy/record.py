"""The view in memory, and how compiled code asks a hook: with a pointer to it, by its address."""

from __future__ import annotations

from typing import Any

import numba
import numpy as np
from llvmlite import ir
from numba import types
from numba.extending import intrinsic

from simmpp.machine.messages import USER_WORDS
from simmpp.policy.view import WORDS, View

_SEVERAL = {"parameter": (WORDS,), "memory": (WORDS,), "words": (USER_WORDS,)}
VIEW = np.dtype([(name, "i8", _SEVERAL.get(name, ())) for name in View.__annotations__])
"""A ``View`` in memory."""
RECORD = numba.from_dtype(VIEW)
"""The same for numba."""


def record_with(parameters: tuple[str, ...]) -> Any:
    """The type of the record, each parameter also a field of its own at the same place."""
    if not parameters:
        return RECORD
    known: Any = VIEW.fields
    formats: dict[str, tuple[Any, int]] = {name: known[name][:2] for name in known}
    first = formats["parameter"][1]
    formats |= {name: (np.dtype("i8"), first + 8 * n) for n, name in enumerate(parameters)}
    dtypes, offsets = zip(*formats.values(), strict=True)
    layout: Any = {"names": list(formats), "formats": list(dtypes), "offsets": list(offsets)}
    return numba.from_dtype(np.dtype(layout | {"itemsize": VIEW.itemsize}))


@intrinsic
def consult(typing_context: Any, address: Any, view: Any) -> Any:
    """Call the hook at ``address`` with a VIEW record, which goes as a pointer.

    A hook passed as a first-class function would cost microseconds to unwrap at every call from
    Python, and one compiled into its caller would leave that caller's cache stale when it changes.
    """

    def call(context: Any, builder: Any, signature: Any, values: Any) -> Any:
        pointer = context.get_value_type(RECORD)
        hook = ir.FunctionType(ir.IntType(64), [pointer]).as_pointer()
        return builder.call(builder.inttoptr(values[0], hook), [values[1]])

    return types.int64(types.int64, RECORD), call
