"""TODO report/text."""
