"""Public interface: a session with every verb, and the verbs as functions."""
