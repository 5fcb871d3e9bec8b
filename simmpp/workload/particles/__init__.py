"""Particles: Monte Carlo transport through cells, recorded as tables like the rays of a picture."""
