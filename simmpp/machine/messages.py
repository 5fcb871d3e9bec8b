"""The kinds of messages that PEs exchange."""

from __future__ import annotations

REQUEST, OBJECT, RAYS, LOAD, USER = range(5)
MESSAGE_KINDS = ("request", "object", "rays", "load", "user")
COPIED_KINDS = MESSAGE_KINDS[:USER]
"""Those whose packing and unpacking a machine has constants for."""
USER_COPIED_AS = REQUEST
"""A message of a policy's own is a few words, as a request is, and costs what that does."""
USER_WORDS = 4
"""Words of a message of a policy's own."""
WORD_BYTES = 8
