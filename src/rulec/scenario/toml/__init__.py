"""TODO scenario/toml."""
