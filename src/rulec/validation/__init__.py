"""Translation validation: each table of a compiled file held against its own formula."""
