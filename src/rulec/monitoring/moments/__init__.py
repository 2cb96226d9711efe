"""The truth of a formula in every state, for every choice of objects."""
