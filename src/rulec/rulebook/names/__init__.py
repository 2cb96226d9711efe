"""Symbol tables: the declarations of files, and references to them."""
