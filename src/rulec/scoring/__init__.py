"""Scoring sampled futures of a vehicle among others."""
