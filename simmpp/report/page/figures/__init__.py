"""The figures of the page: what they are made of, one file a kind, and the table of them."""
