"""The language server, which answers editors while a rulebook is written."""
