"""The files of a monitor: C and C++ headers, C source and build files; or a Rust crate."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Literal, TypeAlias

from rulec.automata.bundle.compiled_rulebook import CompiledRulebook
from rulec.code_generation.c_files import c_header, c_source, cpp_header
from rulec.code_generation.monitor_layout import MonitorLayout, monitor_layout
from rulec.code_generation.reading_code import ReadingCode
from rulec.code_generation.ros2_files import ros2_texts
from rulec.code_generation.rust_files import crate_texts
from rulec.code_generation.rust_reading_code import RustReadingCode
from rulec.code_generation.written_names import prefix_of
from rulec.file_sets import write_together
from rulec.files import make_folder

Language: TypeAlias = Literal["c", "rust", "ros2"]
"""The language of the files: C (and C++), a Rust crate, or a ROS 2 package around the C."""

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
    """The names and contents of the files."""
    name = prefix_of(layout.rulebook.name)
    return {
        f"{name}.h": c_header(layout),
        f"{name}.c": c_source(layout),
        f"{name}.hpp": cpp_header(layout),
        "Makefile": _MAKE.format(name=name),
        "CMakeLists.txt": _CMAKE.format(name=name),
    }


def write_monitor(
    rulebook: CompiledRulebook,
    folder: Path,
    bounds: Mapping[str, int],
    *,
    prove: bool = False,
    language: Language = "c",
) -> list[Path]:
    """Write a monitor to a folder, all files of each folder or none; returns the paths.

    ``bounds`` are the most objects present at a time, by type. With ``prove`` there is a report,
    too. Raises RulecError R0702, R0750, and with ``prove`` R0751 to R0753.
    """
    code = RustReadingCode if language == "rust" else ReadingCode
    layout = monitor_layout(rulebook, bounds, code)
    written = {"c": monitor_texts, "rust": crate_texts, "ros2": ros2_texts}
    texts = written[language](layout)
    if prove:
        # These import NumPy and everything needed for judging.
        from rulec.code_generation.compiled_c.c_library import CLibrary
        from rulec.code_generation.compiled_c.rust_library import RustLibrary
        from rulec.code_generation.proof.monitor_proof import proof_report

        library = RustLibrary(layout) if language == "rust" else CLibrary(layout)
        texts[f"{prefix_of(rulebook.name)}_proof.txt"] = proof_report(library)
    for inner in dict.fromkeys(Path(name).parent for name in texts):
        own = {Path(name).name: text for name, text in texts.items() if Path(name).parent == inner}
        make_folder(folder / inner)
        write_together(folder / inner, {name: text.encode() for name, text in own.items()})
    return [folder / name for name in texts]
