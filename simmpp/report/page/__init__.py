"""The report of a folder of rows: one HTML page that needs nothing else, its figures as files."""
