"""States, traces and counterexamples synthesised from what monitors read."""
