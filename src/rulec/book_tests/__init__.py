"""Run the examples of a rulebook and measure what they cover."""
