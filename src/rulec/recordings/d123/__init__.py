"""Logs and maps of 123D, in Arrow files."""
