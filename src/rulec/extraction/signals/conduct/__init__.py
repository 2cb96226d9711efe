"""Signals of what ego does beyond following its lane, and of whether something makes it do so."""
