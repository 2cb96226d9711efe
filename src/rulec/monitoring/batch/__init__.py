"""Many traces at once: machines run over columns of letters, one step of all traces at a time."""
