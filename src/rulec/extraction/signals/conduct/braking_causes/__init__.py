"""What may make ego brake, stand or be slow, and what surely does."""
