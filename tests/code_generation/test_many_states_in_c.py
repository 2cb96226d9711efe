"""Ten million states judged by monitors in C and by Python's, and what they say compared.

Of the small rulebooks most, for a state of `de` takes forty times as long as one of `esterle2019`.
"""

import shutil
from random import Random

import pytest

import rulec
from rulec.code_generation.compiled_c.c_library import CLibrary
from rulec.code_generation.monitor_layout import monitor_layout
from rulec.code_generation.proof.monitor_proof import BothMonitors
from rulec.code_generation.proof.random_drives import drives, table_drives
from rulec.rulebook.files.search_path import available_rulebooks
from support.builders.monitored_books import NARROW

pytestmark = [
    pytest.mark.long,
    pytest.mark.skipif(shutil.which("cc") is None, reason="there is no C compiler"),
]
MANY = {"esterle2019": (6_000_000, 500_000, 3_200_000), "narrow": (200_000, 30_000, 100_000)}
FEWER = (1_000, 300, 1_500)
BOOKS = ["narrow", *sorted({*available_rulebooks()} - {"schemas"})]


@pytest.mark.parametrize("book", BOOKS)
def test_states_are_judged_alike(book, record_property):
    """States of which all is known, of which not all is, and such as letters are made into."""
    source = rulec.parse_rulebook(NARROW) if book == "narrow" else book
    layout = monitor_layout(rulec.compile_rulebook(source, step_s=1), {})
    library, chance = CLibrary(layout), Random(book)
    known, unknown, of_tables = MANY.get(book, FEWER)
    n = 0
    for share, n_states in ((0.0, known), (0.1, unknown)):
        both = BothMonitors(library, is_known=share == 0)
        for drive in drives(layout, chance, n_states, share):
            for text in both.judge(drive):
                n += 1
                assert text == ""
    both = BothMonitors(library, is_known=True)
    for word in table_drives(layout, chance, of_tables):
        for text in both.judge_word(word):
            n += 1
            assert text == ""
    record_property("states", n)
    # Facts cut some drives short.
    assert n > 0.9 * (known + unknown + of_tables)
