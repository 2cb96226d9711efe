"""Scores of sampled futures of a vehicle among others."""
