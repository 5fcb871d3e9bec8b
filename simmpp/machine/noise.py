"""Noise of a machine: factors near 1, of which each go at computing takes one.

Factors are lognormal: exp(noise x z) with the 256 equally likely z of the standard normal
distribution, made to have a mean of 1. They are whole numbers, made of whole numbers: ``decimal``
rounds an exponential correctly, so that they are the same on every machine.
"""

from __future__ import annotations

from decimal import Context, Decimal, localcontext
from fractions import Fraction
from functools import cache

ONE = 1 << 24
"""The factor 1."""
DRAWS = 256
"""Factors, equally likely."""

# fmt: off
_QUANTILES = (
    49, 147, 245, 343, 441, 539, 637, 735, 833, 932, 1030, 1128, 1227, 1326, 1425, 1524, 1623,
    1722, 1821, 1921, 2021, 2121, 2221, 2322, 2422, 2523, 2625, 2726, 2828, 2930, 3032, 3135, 3238,
    3341, 3445, 3549, 3654, 3758, 3864, 3969, 4076, 4182, 4289, 4397, 4505, 4614, 4723, 4833, 4943,
    5054, 5166, 5278, 5391, 5504, 5618, 5734, 5849, 5966, 6083, 6202, 6321, 6441, 6562, 6684, 6806,
    6930, 7055, 7182, 7309, 7437, 7567, 7698, 7831, 7964, 8100, 8236, 8374, 8514, 8656, 8799, 8944,
    9091, 9240, 9391, 9545, 9700, 9858, 10019, 10182, 10348, 10516, 10688, 10863, 11041, 11223,
    11409, 11599, 11793, 11992, 12195, 12404, 12618, 12838, 13064, 13298, 13539, 13788, 14045,
    14313, 14591, 14881, 15184, 15502, 15836, 16189, 16563, 16962, 17390, 17853, 18357, 18912,
    19533, 20240, 21066, 22066, 23352, 25205, 28856,
)
# fmt: on
"""10^4 times the normal distribution's quantiles of (128.5, 129.5, ... 255.5) / 256."""


@cache
def factors(noise: str) -> tuple[int, ...]:
    """(DRAWS,) factors times ONE, rising; ``noise`` is the deviation of their logarithm."""
    sigma = Fraction(noise)
    with localcontext(Context(prec=40)):
        half = [Decimal(sigma.numerator * z) / (sigma.denominator * 10**4) for z in _QUANTILES]
        raw = [z.exp() for z in (*(-z for z in reversed(half)), *half)]
        mean = sum(raw, Decimal(0)) / len(raw)
        return tuple(int((ONE * each / mean).to_integral_value()) for each in raw)
