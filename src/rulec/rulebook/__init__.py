"""Rulebooks as meant: found, read, names resolved, types checked.

The way through: ``loader`` asks ``finding`` for files and ``rulec.syntax`` for their trees;
``resolve`` makes one rulebook of them: ``symbols`` collects what the vocabularies and the rulebook
declare, and ``translate`` turns each rule into formulas of ``rulec.logic``, looking up its atoms in
its ``scope``. ``model`` is what comes out.
"""
