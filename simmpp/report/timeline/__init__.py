"""Runs as timelines: slices of the time of every PE, arrows between them, and counters."""
