"""What names mean in a document, and where they stand in all of them."""
