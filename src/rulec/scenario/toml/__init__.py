"""Reading scenarios from TOML files, with a source location for every mistake."""
