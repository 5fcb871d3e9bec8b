"""What a run writes down: event log and counters."""
