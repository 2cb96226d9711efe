"""Two or more rulebooks side by side."""
