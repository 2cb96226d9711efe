"""Verification of many traces in arrays, with any objects: each rule once for all of them."""
