"""TODO book_tests."""
