"""The compiled rulebook as data and as a file: JSON, version 7."""
