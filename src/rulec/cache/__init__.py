"""What is kept from one call to the next: the folder, its owner, values in files."""
