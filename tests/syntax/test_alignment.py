"""Marks that stood in one column do so again, unless a row would become too long."""

from rulec.syntax.formatting.document import WIDTH, LaidOutLine
from rulec.syntax.formatting.file_layout import align_marks

LONG, SHORT = 10, 2


def rows(rest):
    first = LaidOutLine("a" * LONG + "= x", mark=LONG)
    second = LaidOutLine("b" * SHORT + "= " + "y" * rest, mark=SHORT)
    align_marks([(first, 5), (second, 5)])
    return first.code, second.code


def test_marks_of_one_column_are_aligned_while_there_is_room():
    rest = WIDTH - LONG - len("= ")
    first, second = rows(rest)
    assert first.index("=") == second.index("=") == LONG
    assert len(second) == WIDTH


def test_marks_stay_where_a_row_would_become_too_long():
    first, second = rows(WIDTH - LONG - len("= ") + 1)
    assert (first.index("="), second.index("=")) == (LONG, SHORT)
