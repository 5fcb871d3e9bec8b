"""Who wins where, by how much, and whether seeds can tell: in numbers, then in one sentence."""
