"""Trace rules and constants through the books they were inherited from."""
