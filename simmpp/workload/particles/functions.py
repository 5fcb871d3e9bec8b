"""Logarithm, sine and cosine of our own: those of the mathematical library differ by computer.

Polynomials of Sun's fdlibm (e_log.c, k_sin.c, k_cos.c), whose results are within 1 ulp.
"""

from __future__ import annotations

import numpy as np

from simmpp.common.compiled import kernel

LN2_HIGH, LN2_LOW = 6.93147180369123816490e-01, 1.90821492927058770002e-10
ROOT_TWO = 1.4142135623730951
L1, L2, L3, L4, L5, L6, L7 = (
    *(6.666666666666735130e-01, 3.999999999940941908e-01, 2.857142874366239149e-01),
    *(2.222219843214978396e-01, 1.818357216161805012e-01, 1.531383769920937332e-01),
    1.479819860511658591e-01,
)
S1, S2, S3, S4, S5, S6 = (
    *(-1.66666666666666324348e-01, 8.33333333332248946124e-03, -1.98412698298579493134e-04),
    *(2.75573137070700676789e-06, -2.50507602534068634195e-08, 1.58969099521155010221e-10),
)
C1, C2, C3, C4, C5, C6 = (
    *(4.16666666666666019037e-02, -1.38888888888741095749e-03, 2.48015872894767294178e-05),
    *(-2.75573143513906633035e-07, 2.08757232129817482790e-09, -1.13596475577881948265e-11),
)
TURN = 6.283185307179586
FRACTION, ONE = 0xFFFFFFFFFFFFF, 0x3FF0000000000000
"""Bits of a float64: those behind the point, and those of 1.0."""


@kernel
def log_of(x: float) -> float:
    """The natural logarithm of a normal number above 0."""
    bits = np.float64(x).view(np.int64)
    exponent = (bits >> 52) - 1023
    mantissa = np.int64((bits & FRACTION) | ONE).view(np.float64)
    if mantissa > ROOT_TWO:
        mantissa, exponent = 0.5 * mantissa, exponent + 1
    f = mantissa - 1.0
    s = f / (2.0 + f)
    z = s * s
    r = z * (L1 + z * (L2 + z * (L3 + z * (L4 + z * (L5 + z * (L6 + z * L7))))))
    half = 0.5 * f * f
    low = s * (half + r) + exponent * LN2_LOW
    return exponent * LN2_HIGH - ((half - low) - f)


@kernel
def sine(x: float) -> float:
    """Of an angle from -pi/4 to pi/4."""
    z = x * x
    return x + x * z * (S1 + z * (S2 + z * (S3 + z * (S4 + z * (S5 + z * S6)))))


@kernel
def cosine(x: float) -> float:
    """Of an angle from -pi/4 to pi/4."""
    z = x * x
    r = z * (C1 + z * (C2 + z * (C3 + z * (C4 + z * (C5 + z * C6)))))
    return 1.0 - (0.5 * z - z * r)


@kernel
def on_circle(turns: float) -> tuple[float, float]:
    """Cosine and sine of an angle in turns, from 0 to 1."""
    quarter = int(4.0 * turns + 0.5)
    angle = (turns - 0.25 * quarter) * TURN
    c, s = cosine(angle), sine(angle)
    if quarter == 1:
        return -s, c
    if quarter == 2:
        return -c, -s
    if quarter == 3:
        return s, -c
    return c, s
