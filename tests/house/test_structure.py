"""Sizes of the package and of its folders, calls and imports within its functions."""

import pytest

from support.leftovers import POSITIONAL_CALLS, UNEXPLAINED_IMPORTS, WIDE_FOLDERS
from support.source_modules import PACKAGE, rooms, source_modules

MOST_LINES = 131_950
"""What stood before values could be unknown took 41,000; evidence has 13,000, formats and
fleets 24,000, ready traces read as columns 700, bounds and proofs 6,000, the words and tools of
more law 6,500; monitors in C, the compiler without Spot and what can be driven have the rest."""
MOST_FILES = 15
A_FILE_FOR_EACH = {"cli/commands": "verb"}
"""Folders that are as wide as there is something to list."""


def is_code(line):
    return bool(line.strip()) and not line.lstrip().startswith("#")


def code_lines():
    return sum(is_code(line) for module in source_modules() for line in module.lines)


def test_the_package_does_not_grow_unnoticed():
    assert code_lines() <= MOST_LINES


@pytest.mark.parametrize("folder", list(rooms()), ids=lambda path: str(path.relative_to(PACKAGE)))
def test_a_folder_can_be_seen_at_a_glance(folder):
    name = str(folder.relative_to(PACKAGE))
    if name not in A_FILE_FOR_EACH.keys() | WIDE_FOLDERS:
        assert len(list(folder.glob("*.py"))) <= MOST_FILES


def positional_calls():
    """Calls with many positional arguments: the file and what is called."""
    for module in source_modules():
        for called in module.wide_calls:
            yield f"{module.name} {called}"


def test_no_call_has_more_than_five_positional_arguments():
    assert set(positional_calls()) - POSITIONAL_CALLS == set()


REASON_OF_A_FILE = "# Imports within functions: "


def unexplained_imports():
    """Files that import within a function without a comment beside or above that says why.

    A comment of the module's own, at the beginning of a line, gives the reason for all of a file.
    """
    for module in source_modules():
        if any(line.startswith(REASON_OF_A_FILE) for line in module.lines):
            continue
        for number in sorted(module.inner_imports):
            above = number - 1
            while above in module.inner_imports:
                above -= 1
            if "# " not in module.lines[number - 1] and "# " not in module.lines[above - 1]:
                yield module.name


def test_an_import_within_a_function_has_its_reason():
    assert set(unexplained_imports()) - UNEXPLAINED_IMPORTS == set()
