"""The same traffic in other words: written in another way, or with less said of it."""
