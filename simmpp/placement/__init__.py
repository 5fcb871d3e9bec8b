"""Who owns, who holds and who starts what."""
