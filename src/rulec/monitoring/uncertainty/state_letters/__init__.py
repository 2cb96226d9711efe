"""The letters that a state may have of which not all is known."""
