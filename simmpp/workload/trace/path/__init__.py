"""Path tracing: rays scatter by chance, drawn by counting: a function of seed and place alone."""
