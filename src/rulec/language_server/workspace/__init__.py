"""The folders and documents of an editor, and positions in them."""
