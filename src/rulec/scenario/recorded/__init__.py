"""Recordings of traffic on a real road, and scenarios along ego's road made of them."""
