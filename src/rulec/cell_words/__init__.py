"""Words of recorded drives evaluated in the cells of a navigation graph."""

from rulec.cell_words.cell_words import CellWords, cell_words

__all__ = ["CellWords", "cell_words"]
