"""What a PE does of rounds and of results."""
