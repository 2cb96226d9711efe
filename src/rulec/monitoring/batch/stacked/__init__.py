"""Verification of many traces in arrays, whatever their objects: each rule once for all."""
