"""TODO report/verdicts."""
