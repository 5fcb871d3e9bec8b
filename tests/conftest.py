"""Settings of all tests."""

from __future__ import annotations

import os

from hypothesis import settings

# The first example of a test may compile for seconds. On CI the same examples are tried each time.
settings.register_profile("simmpp", deadline=None, derandomize="CI" in os.environ)
settings.load_profile("simmpp")
