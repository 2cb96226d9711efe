"""What recordings of all formats say that cannot be so, or hardly."""
