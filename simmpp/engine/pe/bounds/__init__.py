"""Memory that ends: room for rays and objects, credits, what is taken in, the way out."""
