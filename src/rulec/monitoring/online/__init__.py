"""Runtime monitoring: Mealy monitors that take one state after the other."""
