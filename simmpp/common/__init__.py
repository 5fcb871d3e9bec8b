"""What any layer may use: errors, units, YAML, files, random streams, compiled code."""
