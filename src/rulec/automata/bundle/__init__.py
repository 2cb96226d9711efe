"""TODO automata/bundle."""
