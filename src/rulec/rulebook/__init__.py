"""Rulebooks as meant: found, read, names resolved, types checked."""
