"""Truth of a formula at every state for every choice of objects."""
