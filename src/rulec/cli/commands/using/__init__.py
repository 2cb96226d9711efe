"""Commands to compile, and to look things up."""
