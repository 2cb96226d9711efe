"""Public interface: a session with every verb, and verbs as functions."""
