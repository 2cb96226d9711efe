"""The words that some modules define, for tests of these alone."""

from rulec.extraction.signals.words import WordsByModule


def words_of(*modules):
    return WordsByModule(modules)
