"""The machine: torus, costs, messages, presets."""
