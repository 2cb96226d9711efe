"""Commands to write rules."""
