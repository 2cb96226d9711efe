"""Where a formula holds in a trace: at every state and for every choice of objects, on arrays."""
