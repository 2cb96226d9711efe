"""A monitor in Rust, compiled as a library with the same interface as one in C."""

from __future__ import annotations

import shutil
from pathlib import Path

from rulec.code_generation.code_messages import no_rust_compiler
from rulec.code_generation.compiled_c.c_library import CLibrary, first_line_of, run_compiler
from rulec.code_generation.rust_files import rust_harness, rust_source


class RustLibrary(CLibrary):
    """A crate's source and the functions that a proof calls, compiled by ``rustc``.

    Raises RulecError R0751 if ``rustc`` is missing, R0752 if it fails.
    """

    language = "Rust"

    def _compiled(self, folder: Path, source: str | None) -> Path:
        if shutil.which("rustc") is None:
            raise no_rust_compiler()
        layout, name = self.layout, self._prefix
        (folder / "lib.rs").write_text(rust_source(layout) if source is None else source, "utf-8")
        (folder / "harness.rs").write_text(rust_harness(layout), "utf-8")
        level = "2" if self._level == "-O2" else "0"
        command = ["rustc", "--edition", "2021", "-D", "warnings", "-C", f"opt-level={level}"]
        crate = ["--crate-type", "rlib", "--crate-name", name, "lib.rs", "-o", f"lib{name}.rlib"]
        self.compiler_version = first_line_of(["rustc", "--version"])
        self.command = run_compiler([*command, *crate], folder)
        own = ["--crate-type", "cdylib", "--crate-name", f"{name}_harness", "harness.rs"]
        own += ["--extern", f"{name}=lib{name}.rlib", "-o", f"{name}.so"]
        run_compiler([*command, "-A", "non_snake_case", *own], folder)
        return folder / f"{name}.so"
