"""Trees of files that were read without a mistake, kept from one call to the next."""
