"""The language server: what an editor asks while a rulebook is written."""
