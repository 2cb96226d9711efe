"""Compare rules and rulebooks by what they forbid."""
