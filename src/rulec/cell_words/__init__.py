"""Words of recorded drives evaluated in the cells of a navigation graph."""

from rulec.cell_words.cell_words import CellWords, cell_words
from rulec.cell_words.mirrored_scene import on_side_of

__all__ = ["CellWords", "cell_words", "on_side_of"]
