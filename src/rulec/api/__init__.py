"""The public surface: a session with every verb, and the verbs as functions."""
