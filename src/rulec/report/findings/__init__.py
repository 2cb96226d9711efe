"""TODO report/findings."""
