"""TODO report/tests."""
