"""One point: its inputs, its simulation, its row and what is said of it."""
