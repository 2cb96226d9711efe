"""A recorded drive as a trace of the signals that a vocabulary declares."""
