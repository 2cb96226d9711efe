"""Drives judged on engines that exist: a table of tracks or traces in, one of findings out."""
