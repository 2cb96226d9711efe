"""The files of a monitor in C: headers for C and C++, source, and what builds them."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from rulec.automata.bundle.compiled_rulebook import CompiledRulebook
from rulec.code_generation.c_files import c_header, c_source, cpp_header
from rulec.code_generation.monitor_layout import MonitorLayout, monitor_layout
from rulec.code_generation.written_names import prefix_of
from rulec.file_sets import write_together
from rulec.files import make_folder

_MAKE = """\
# A library of the monitor; it takes a compiler for C99 and nothing else.
CFLAGS ?= -O2
CFLAGS += -std=c99 -Wall -Wextra -Wconversion -pedantic

lib{name}.a: {name}.o
\t$(AR) rcs $@ $^

{name}.o: {name}.c {name}.h
\t$(CC) $(CFLAGS) -c -o $@ $<

clean:
\t$(RM) lib{name}.a {name}.o

.PHONY: clean
"""

_CMAKE = """\
cmake_minimum_required(VERSION 3.13)
project({name}_monitor C)

add_library({name} STATIC {name}.c)
target_include_directories({name} PUBLIC ${{CMAKE_CURRENT_SOURCE_DIR}})
set_target_properties({name} PROPERTIES C_STANDARD 99 C_STANDARD_REQUIRED ON C_EXTENSIONS OFF)
"""


def monitor_texts(layout: MonitorLayout) -> dict[str, str]:
    """The files' names and what is in them."""
    name = prefix_of(layout.rulebook.name)
    return {
        f"{name}.h": c_header(layout),
        f"{name}.c": c_source(layout),
        f"{name}.hpp": cpp_header(layout),
        "Makefile": _MAKE.format(name=name),
        "CMakeLists.txt": _CMAKE.format(name=name),
    }


def write_monitor(
    rulebook: CompiledRulebook, folder: Path, bounds: Mapping[str, int], *, prove: bool = False
) -> list[Path]:
    """Write a monitor to a folder, all files or none; the paths.

    ``bounds`` are how many objects there may be at a time, by type. If it is to ``prove`` there is
    a report, too. Raises RulecError R0702, R0750, and to prove R0751 to R0753.
    """
    layout = monitor_layout(rulebook, bounds)
    texts = monitor_texts(layout)
    if prove:
        # numpy, and all that judges
        from rulec.code_generation.proof.monitor_proof import proof_report

        texts[f"{prefix_of(rulebook.name)}_proof.txt"] = proof_report(layout)
    make_folder(folder)
    write_together(folder, {name: text.encode() for name, text in texts.items()})
    return [folder / name for name in texts]
