"""Ways from a case to its row: simulation, and the paper's analytical model."""
