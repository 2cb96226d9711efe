"""Developers' programs that write the files generated from others."""
