"""Questions about rulebooks rather than about traces."""
