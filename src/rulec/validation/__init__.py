"""Translation validation: each table of a compiled file is proved against its own formula."""
