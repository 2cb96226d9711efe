"""The process in which compilers run, and which of them."""
