"""Many traces at once: machines run over columns of letters, a step of all traces at a time."""
