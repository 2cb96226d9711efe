"""Logs and maps of 123D, stored in Arrow files."""
