"""Path tracing: rays that scatter by chance, with numbers that depend on nothing but their place."""
