"""What a PE does: the model, called by every engine."""
