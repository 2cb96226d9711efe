"""TODO report/maneuvers."""
