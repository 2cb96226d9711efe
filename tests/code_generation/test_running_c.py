"""Monitors in C as they run on random states: sanitizers, Valgrind, the depth of the stack."""

import re
import shutil
import subprocess

import pytest

import rulec
from rulec.code_generation.monitor_layout import monitor_layout
from support.builders.monitor_drivers import NUMBERS, random_driver

pytestmark = pytest.mark.long

BOOKS = [("numbers", {"car": 3, "person": 2}), ("esterle2019", {"vehicle": 2}), ("de", {})]
CHECKS = ["-fsanitize=address,undefined", "-fno-sanitize-recover=all"]
MOST_STACK_BYTES = 1024
"""As docs/online.md says."""


def written(folder, book, objects, n_states):
    compiled = rulec.compile_rulebook(
        rulec.parse_rulebook(NUMBERS) if book == "numbers" else book, step_s=1
    )
    rulec.write_monitor(compiled, folder, objects)
    text = random_driver(monitor_layout(compiled, objects), book, n_states)
    (folder / "driver.c").write_text(text, encoding="utf-8")
    return [str(folder / "driver.c"), str(folder / f"{book}.c")]


def call(*command, **options):
    done = subprocess.run(command, capture_output=True, text=True, check=False, **options)
    assert done.returncode == 0, (done.stdout + done.stderr)[-4000:]
    return done


def has_sanitizers(compiler, folder):
    if shutil.which(compiler) is None:
        return False
    (folder / "nothing.c").write_text("int main(void) { return 0; }\n")
    command = [compiler, *CHECKS, "nothing.c", "-o", "nothing"]
    return subprocess.run(command, cwd=folder, capture_output=True, check=False).returncode == 0


@pytest.mark.parametrize("compiler", ["gcc", "clang"])
@pytest.mark.parametrize(("book", "objects"), BOOKS)
def test_sanitizers_find_nothing(book, objects, compiler, tmp_path):
    if not has_sanitizers(compiler, tmp_path):
        pytest.skip(f"there is no {compiler} with its sanitizers")
    sources = written(tmp_path, book, objects, 20_000)
    call(compiler, "-std=c99", "-O1", "-g", *CHECKS, *sources, "-o", str(tmp_path / "run"))
    assert call(str(tmp_path / "run")).stderr == ""


@pytest.mark.skipif(shutil.which("valgrind") is None, reason="there is no Valgrind")
@pytest.mark.parametrize(("book", "objects"), BOOKS)
def test_valgrind_finds_nothing(book, objects, tmp_path):
    sources = written(tmp_path, book, objects, 500)
    call("gcc", "-std=c99", "-O1", "-g", *sources, "-o", str(tmp_path / "run"))
    done = call("valgrind", "--error-exitcode=3", "--leak-check=full", str(tmp_path / "run"))
    assert "ERROR SUMMARY: 0 errors" in done.stderr
    # The C library's own start aside, nothing is ever allocated.
    assert "total heap usage: 0 allocs" in done.stderr


@pytest.mark.parametrize("optimized", ["-O0", "-O2"])
@pytest.mark.parametrize(("book", "objects"), BOOKS)
def test_the_stack_is_bounded(book, objects, optimized, tmp_path):
    """The deepest chain of calls, by what gcc says of each function's frame; none is recursive."""
    _, source = written(tmp_path, book, objects, 1)
    call("gcc", "-std=c99", optimized, "-fcallgraph-info=su", "-c", source, cwd=tmp_path)
    (graph,) = tmp_path.glob("*.ci")
    text = graph.read_text(encoding="utf-8")
    frames = {
        name: None if kind == "dynamic" else int(size)
        for name, size, kind in re.findall(
            r'title: "([^"]+)" label: "[^"]*?(\d+) bytes \(([\w,]+)\)', text
        )
    }
    assert f"{book}_step" in frames
    assert None not in frames.values()
    calls: dict[str, set[str]] = {}
    for caller, callee in re.findall(r'sourcename: "([^"]+)" targetname: "([^"]+)"', text):
        calls.setdefault(caller, set()).add(callee)

    def depth(name, above=()):
        assert name not in above, "recursion"
        return frames.get(name, 0) + max(
            (depth(one, (*above, name)) for one in calls.get(name, ())), default=0
        )

    deepest = max(map(depth, frames))
    assert deepest <= MOST_STACK_BYTES
