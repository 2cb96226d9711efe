"""Random rulebooks, traces, graphs, scenarios and files, for Hypothesis or by a seed."""
