"""Slow, obviously correct versions of the clever parts of simmpp, for the tests to compare with."""
