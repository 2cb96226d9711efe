"""Answer questions about rulebooks rather than about traces."""
