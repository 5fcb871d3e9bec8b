"""Nothing is compiled for two kinds of numbers, nor for two layouts."""

from __future__ import annotations

import subprocess
import sys

import numba
import pytest

from simmpp.common.compiled import kernel, njit

PROGRAM = """
import sys
from numba.core.dispatcher import Dispatcher
from numba.types import Array, BaseTuple, Boolean, Number, unliteral
import simmpp
from simmpp.common.compiled import _Compiled
from simmpp.workload.trace.shading import render
from simmpp.workload.trace.verify import verify

def essence(kind):  # what may differ: a hash table is compiled for each kind of its rows
    if isinstance(kind, BaseTuple):
        return tuple(map(essence, kind))
    if isinstance(kind, Array):
        return kind.dtype, kind.ndim
    return None if isinstance(unliteral(kind), Number | Boolean) else kind

for name in ("gears:1", "mountain:2"):
    scene, picture = simmpp.load_scene(name), simmpp.Picture(resolution=8)
    workload = simmpp.trace(scene, picture)
    render(scene, picture, workload)
    verify(scene, picture, workload, workload.hits[:0], workload.hits[:0])
    machine = simmpp.make_machine(processors=4)
    placement = simmpp.place(workload, 4, simmpp.Memory(), simmpp.PlacementRules(), 0)
    for policy in ("object", "ray", "concurrent"):
        for engine in ("compiled", "simpy"):
            simmpp.simulate(
                workload, machine, placement, simmpp.PolicyParameters(policy), engine=engine
            )
for module in [each for name, each in sys.modules.items() if name.startswith("simmpp.")]:
    for function in vars(module).values():
        if isinstance(function, Dispatcher):
            assert isinstance(function, _Compiled), function
            kinds = [tuple(map(essence, signature)) for signature in function.signatures]
            assert len(set(kinds)) == len(kinds), (function, function.signatures)
"""


def test_nothing_is_compiled_twice() -> None:
    subprocess.run([sys.executable, "-c", PROGRAM], check=True)


def test_python_calls_no_kernel() -> None:
    @kernel
    def twice(x: int) -> int:
        return 2 * x

    @njit
    def six() -> int:
        return twice(numba.int32(1)) + twice(2)

    assert six() == 6
    assert len(twice.signatures) == 1  # type: ignore[attr-defined]
    with pytest.raises(TypeError, match="twice is called by compiled code only"):
        twice(1)
