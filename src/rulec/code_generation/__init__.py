"""Compiled rulebooks as monitors in C and Rust."""
