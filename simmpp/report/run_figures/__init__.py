"""Pictures of one run: who waited, where messages went, what pixels cost."""
