"""Find vacuous, redundant and conflicting rules."""
