"""Signals of ego's lane changes, and of who has to brake or make way for them."""
