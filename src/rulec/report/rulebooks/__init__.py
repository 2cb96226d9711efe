"""TODO report/rulebooks."""
