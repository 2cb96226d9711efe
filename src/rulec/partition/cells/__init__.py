"""TODO partition/cells."""
