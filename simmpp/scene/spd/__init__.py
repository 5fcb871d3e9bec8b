"""The Standard Procedural Databases (Haines 1987), generated."""
