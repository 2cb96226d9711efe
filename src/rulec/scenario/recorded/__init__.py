"""Recordings of traffic on real roads, and scenarios along ego's road made from them."""
