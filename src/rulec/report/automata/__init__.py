"""TODO report/automata."""
