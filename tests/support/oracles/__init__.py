"""Meanings written down a second time from the documentation; no code of rulec is in them.

``bits`` alone reads columns by rulec's readers: it checks the automata and what runs them.
"""
