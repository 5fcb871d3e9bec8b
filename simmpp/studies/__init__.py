"""What runs many simulations for one question."""
