"""Symbol tables: the declarations of files, and what refers to them."""
