"""The four kinds of messages that PEs exchange."""

from __future__ import annotations

REQUEST, OBJECT, RAYS, LOAD = range(4)
MESSAGE_KINDS = ("request", "object", "rays", "load")
