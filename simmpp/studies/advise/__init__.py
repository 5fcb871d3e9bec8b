"""Which policy, on how many nodes: candidates, what fits, what cannot win, a race of the rest."""
