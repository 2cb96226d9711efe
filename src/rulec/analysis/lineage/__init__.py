"""Trace each rule and constant through the books that it was inherited from."""
