"""Decision diagrams of what is read together, and ways through them."""
