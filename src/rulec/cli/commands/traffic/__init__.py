"""Commands to judge traffic."""
