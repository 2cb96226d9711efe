"""Generated code: harmless whatever a rulebook says, without warnings, as the page shows it."""

import re
import shutil
import subprocess
from dataclasses import replace
from pathlib import Path

import pytest

import rulec
from rulec.automata.mealy_monitor import IMPOSSIBLE
from rulec.cli.main import main
from rulec.code_generation.compiled_c import c_library
from rulec.code_generation.compiled_c.c_library import CLibrary
from rulec.code_generation.monitor_files import monitor_texts
from rulec.code_generation.monitor_layout import EXCLUDED, LEAF, letter_cells, monitor_layout
from rulec.code_generation.written_names import Identifiers, c_string, in_comment, prefix_of
from rulec.diagnostics import RulecError
from rulec.rulebook.rulebook_model import SourceFile

PAGE = Path(__file__).parents[2] / "docs" / "online.md"
COMPILER = shutil.which("cc")
needs_a_compiler = pytest.mark.skipif(COMPILER is None, reason="there is no C compiler")

HOSTILE = [
    "*/ int main(void) { return system(0); } /*",
    "ends in a backslash \\",
    "trigraph ??/",
    "lines\nbroken\r\nand\u2028again\u0085and\x0bso",
    "turned \u202e round \u2066 \u200f \u05d0",
    '"); system("',
    "zero\0and\x1b[31m",
    "%s %n // rulec_step",
    "lone \udcff",
]


@pytest.fixture(scope="module")
def esterle():
    return rulec.compile_rulebook("esterle2019", step_s=1)


@pytest.mark.parametrize("text", HOSTILE)
def test_a_comment_stays_one(text):
    shown = in_comment(text)
    assert shown.isprintable()
    assert not re.search(r"\*/|/\*|//|\?\?|\\|rulec_", shown)
    assert not re.search("[\u0590-\u08ff\u200b-\u200f\u202a-\u202e\u2066-\u2069]", shown)


@pytest.mark.parametrize("text", HOSTILE)
def test_a_literal_has_the_bytes_of_its_text(text):
    written = c_string(text)
    # No escape is followed by anything else in its literal (MISRA C:2012, 4.1).
    assert not re.search(r"\\[0-7]{3}[^\\\"]", written)
    literal = written.replace('" "', "")
    assert re.fullmatch(r'"([ !#-)+->@-\[\]-~]|\\[0-7]{3})*"', literal)
    found = re.sub(rb"\\([0-7]{3})", lambda x: bytes([int(x[1], 8)]), literal[1:-1].encode())
    assert found == text.encode("utf-8", "surrogatepass")


@needs_a_compiler
def test_a_hostile_rulebook_compiles_to_the_same_code(esterle, tmp_path):
    evil = " ".join(HOSTILE)
    rules = [replace(rule, cite=evil, says=evil) for rule in esterle.rules]
    book = replace(
        esterle,
        rules=tuple(rules),
        title=evil,
        law=evil,
        as_of=evil,
        sources=(SourceFile(evil, evil),) * len(esterle.sources),
    )
    CLibrary(monitor_layout(book, {}), optimised=False)
    codes = []
    for one in (esterle, book):
        source = monitor_texts(monitor_layout(one, {}))["esterle2019.c"]
        source = re.sub(r"/\*.*?\*/", "", source, flags=re.DOTALL)
        source = re.sub(r'("(\\.|[^"\\])*" ?)+', '""', source)
        codes.append(re.sub(r"\s+", " ", source))
    assert codes[0] == codes[1]


@pytest.mark.parametrize(
    "name", ["int", "NULL", "Self", "size_t", "uint8_t", "uint_fast16_t", "INT64_C", "UINT8_MAX"]
)
def test_no_name_of_a_language_or_its_headers_is_taken(name):
    assert Identifiers().of(name) == f"{name}_of_rule"


@pytest.mark.parametrize("name", ["limits", "Time", "sem", "std", "names", "test", "m", "main"])
def test_no_monitor_is_called_like_what_it_is_built_with(name):
    assert prefix_of(name) == f"{name.lower()}_of_rule"


def test_values_are_called_unlike_a_monitors_own_constants():
    book = rulec.parse_rulebook(
        "rulebook own\nmost is one of digit, other\nmonitor is one of h, hpp\n"
        "hard rule r { require always (digit or hpp) }\n"
    )
    texts = monitor_texts(monitor_layout(rulec.compile_rulebook(book, step_s=1), {}))
    defined = re.findall(r"#define (\w+)", "".join(texts.values()))
    assert {name for name in defined if defined.count(name) > 1} == set()


@needs_a_compiler
def test_names_of_headers_make_a_monitor(tmp_path):
    names = ("NULL", "size_t", "uint8_t", "Self", "int", "a" * 60, "straße")
    signals = "".join(f"signal {name} default false\n" for name in names)
    rules = "".join(f"hard rule r_{name} {{ require always {name} }}\n" for name in names)
    book = rulec.parse_rulebook(f"rulebook main\n{signals}{rules}")
    rulec.write_monitor(book, tmp_path)
    for compiler in (["cc", "-std=c99"], ["c++", "-x", "c++"]):
        strict = ["-Wall", "-Wextra", "-Wpedantic", "-Werror", "-fsyntax-only"]
        (source,) = tmp_path.glob("*.h") if compiler[0] == "c++" else tmp_path.glob("*.c")
        subprocess.run([*compiler, *strict, source], check=True)


def test_identifiers_are_apart_and_none_of_a_language():
    identifiers = Identifiers()
    names = ["int", "class", "fn", "a-b", "a b", "a__b", "_a", "9", "é", "É", "rulec_x", "int_"]
    found = [identifiers.of(name) for name in names]
    assert len(set(found)) == len(names)
    assert all(re.fullmatch("[a-z](_?[a-zA-Z0-9])*_?[0-9]*", one) for one in found)
    assert not {"int", "class", "fn"} & set(found)
    assert not any("__" in one or one.startswith("rulec_") for one in found)


def class_of(cells, digits):
    """The class of a letter, looked up as the generated monitors do."""
    at = cells[0]
    while at < LEAF:
        at = cells[at + 1 + digits[cells[at]]]
    return IMPOSSIBLE if at == EXCLUDED else at - LEAF


def test_a_diagram_has_the_class_of_every_letter(esterle):
    for rule in [*esterle.rules, *rulec.compile_rulebook("un-r157", step_s=1).rules]:
        sizes = [read.size for read in rule.machine.reads]
        cells = letter_cells(rule.machine.letters, sizes)
        assert len(cells) <= 2000, "less than 4 kB a rule"
        for letter, expected in enumerate(rule.machine.letters):
            digits = []
            for size in sizes:
                letter, digit = divmod(letter, size)
                digits.append(digit)
            assert class_of(cells, digits) == expected


def blocks(language):
    text = PAGE.read_text(encoding="utf-8")
    return re.findall(rf"^```{language}\n(.*?)^```$", text, re.MULTILINE | re.DOTALL)


@needs_a_compiler
def test_the_page_leads_to_a_running_monitor(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert main(["compile", "esterle2019", "--emit", "c", "-o", "build"]) == 0
    Path("watch.c").write_text(blocks("c")[0], encoding="utf-8")
    lines = blocks("c")[0].splitlines()
    assert len(lines) - lines.index("int main(void)") <= 30
    shown = next(block for block in blocks("console") if block.startswith("$ cc "))
    build, run, *printed = shown.splitlines()
    subprocess.run(build[2:], shell=True, check=True)
    done = subprocess.run(run[2:], shell=True, check=True, capture_output=True, text=True)
    assert done.stdout.splitlines() == printed


@pytest.mark.skipif(
    None in map(shutil.which, ("make", "cc", "c++")), reason="there is no make, or no C++ compiler"
)
def test_the_page_leads_to_a_monitor_in_cpp(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert main(["compile", "esterle2019", "--emit", "c", "-o", "build"]) == 0
    Path("watch.cpp").write_text(blocks("cpp")[0], encoding="utf-8")
    shown = next(block for block in blocks("console") if "c++ " in block)
    build, run, *printed = shown.splitlines()
    strict = "c++ -Wall -Wextra -Wconversion -Werror -pedantic "
    subprocess.run(build[2:].replace("c++ ", strict, 1), shell=True, check=True)
    done = subprocess.run(run[2:], shell=True, check=True, capture_output=True, text=True)
    assert done.stdout.splitlines() == printed


@pytest.mark.skipif(shutil.which("make") is None, reason="there is no make")
@needs_a_compiler
def test_make_builds_a_library(esterle, tmp_path):
    rulec.write_monitor(esterle, tmp_path)
    done = subprocess.run(["make", "CFLAGS=-O0 -Werror"], cwd=tmp_path, capture_output=True)
    assert done.returncode == 0, done.stderr
    assert (tmp_path / "libesterle2019.a").exists()


def test_what_there_can_be_no_monitor_of(esterle, tmp_path):
    for rules, objects, said in [
        (replace(esterle, rules=()), {}, "has no rules"),
        (esterle, {"lorry": 2}, "the type `lorry`"),
        (esterle, {"vehicle": 0}, "from 1 to 4096"),
        (rulec.compile_rulebook("de", step_s=1), {"vehicle": 300}, "choices of objects"),
    ]:
        with pytest.raises(RulecError) as caught:
            rulec.write_monitor(rules, tmp_path, objects)
        (diagnostic,) = caught.value.diagnostics
        assert (diagnostic.code, said in diagnostic.message) == ("R0750", True)
    assert list(tmp_path.iterdir()) == []


def test_types_that_are_not_named_keep_their_seats(esterle):
    seats = monitor_layout(esterle, {"vehicle": 3}).seats
    (first, end), (others, last) = seats["vehicle"], seats["pedestrian"]
    assert (end - first, last - others) == (3, 16)
    assert not set(range(first, end)) & set(range(others, last))
    with pytest.raises(RulecError, match="R0750") as caught:
        monitor_layout(esterle, {"vehicles": 3})
    assert caught.value.diagnostics[0].help == "did you mean `vehicle`?"


@pytest.mark.parametrize("given", [[], ["--step", "0.5"]])
def test_a_step_that_nobody_asked_for_is_said(given, tmp_path, capsys):
    (tmp_path / "two.rules").write_text(
        "rulebook two\nsignal a, b\n"
        "hard rule quick { require always (a implies eventually[<= 2 s] b) }\n"
        "hard rule plain { require always not (a and b) }\n"
    )
    words = ["compile", str(tmp_path / "two.rules"), "--emit", "c", "-o", str(tmp_path)]
    assert main([*words, *given]) == 0
    said = "for states 1 s apart, as 1 rule has bounds in seconds"
    assert (said in capsys.readouterr().err) == (not given)


@pytest.mark.parametrize(
    "options", [["--objects", "vehicle=2"], ["--emit", "c", "--objects", "vehicle"]]
)
def test_options_that_make_no_sense(options, tmp_path, capsys):
    assert main(["compile", "esterle2019", "-o", str(tmp_path / "out"), *options]) == 2
    assert "--objects" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("bounds", "said"),
    [
        (["vehicle=1.5"], "`vehicle=1.5` is not TYPE=N, such as `vehicle=16`"),
        (["=3"], "`=3` is not TYPE=N"),
        (["vehicle=3", "vehicle=4"], "`vehicle` has two bounds"),
    ],
)
def test_bounds_that_make_no_sense(bounds, said, tmp_path, capsys):
    options = [part for bound in bounds for part in ("--objects", bound)]
    arguments = ["compile", "esterle2019", "--emit", "c", "-o", str(tmp_path / "out"), *options]
    assert main(arguments) == 2
    assert said in capsys.readouterr().err


@pytest.mark.parametrize(
    ("script", "code", "said"),
    [
        (None, "R0751", "`no-such-compiler` is not found"),
        ("exit 3", "R0752", "it ended with status 3 without any output"),
        ("kill -SEGV $$", "R0752", "it was ended by signal 11 without any output"),
        (r"printf 'f\374r' >&2; exit 1", "R0752", "has failed: f\N{REPLACEMENT CHARACTER}r"),
        ("exit 0", "R0752", "it has written no library for this Python: esterle2019.so: "),
    ],
)
def test_a_compiler_that_is_not_there_or_fails(esterle, script, code, said, monkeypatch, tmp_path):
    compiler = tmp_path / "compiler"
    if script is not None:
        compiler.write_text(f"#!/bin/sh\n{script}\n")
        compiler.chmod(0o755)
    monkeypatch.setenv("CC", "no-such-compiler" if script is None else str(compiler))
    with pytest.raises(RulecError) as caught:
        CLibrary(monitor_layout(esterle, {}))
    (found,) = caught.value.diagnostics
    assert found.code == code
    assert said in found.message
    assert "`CC`" in found.help


def test_a_variable_that_is_no_command(esterle, monkeypatch):
    monkeypatch.setenv("CC", "gcc 'unclosed")
    with pytest.raises(RulecError) as caught:
        CLibrary(monitor_layout(esterle, {}))
    (found,) = caught.value.diagnostics
    assert (found.code, "not a command: `gcc 'unclosed`" in found.message) == ("R0751", True)
    (advised,) = re.findall("such as `(.*?)`", found.help)
    if shutil.which(advised.split()[0]):  # a library for another machine cannot be loaded
        monkeypatch.setenv("CC", advised)
        CLibrary(monitor_layout(esterle, {}))


def test_an_empty_variable_is_none(monkeypatch):
    monkeypatch.setenv("CC", " ")
    with monkeypatch.context() as patched:
        patched.setattr("shutil.which", lambda name: f"/bin/{name}")
        assert c_library.compiler() == ["cc"]
