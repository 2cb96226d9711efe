"""The same monitor as a crate of Rust: the same proof, and what cargo says."""

import re
import shutil
import subprocess
from dataclasses import replace
from fractions import Fraction
from pathlib import Path

import pytest
from hypothesis import Phase, given, settings

import rulec
from rulec.cli.main import main
from rulec.code_generation.compiled_c.c_library import CMonitor
from rulec.code_generation.compiled_c.rust_library import RustLibrary
from rulec.code_generation.monitor_layout import monitor_layout
from rulec.code_generation.proof.monitor_proof import proof_of
from rulec.code_generation.rust_files import crate_texts, rust_source
from rulec.code_generation.rust_form import formed
from rulec.code_generation.rust_reading_code import RustReadingCode
from rulec.code_generation.written_names import rust_string
from rulec.rulebook.rulebook_model import SourceFile
from support.builders.monitored_books import BLAMED, SINCE, WHO_IS_BLAMED
from support.builders.national_books import NATIONAL
from support.builders.rulebooks import compile_here
from support.generators.random_rulebooks import rulebook
from support.generators.seeds import seeds

needs_rust = pytest.mark.skipif(shutil.which("rustc") is None, reason="there is no Rust compiler")
needs_rustfmt = pytest.mark.skipif(shutil.which("rustfmt") is None, reason="there is no rustfmt")
needs_cargo = pytest.mark.skipif(shutil.which("cargo") is None, reason="there is no cargo")
PAGE = Path(__file__).parents[2] / "docs" / "onboard.md"
HOSTILE = [
    "*/ fn main() { panic!() } /*",
    "ends in a backslash \\",
    "trigraph ??/",
    "lines\nbroken\r\nand\u2028again\u0085and\x0bso",
    "turned \u202e round \u2066 \u200f \u05d0",
    '"# ; panic!("',
    "zero\0and\x1b[31m",
    "#![allow(unsafe_code)] // rulec_step",
    "lone \udcff",
]


def layout_of(compiled):
    return monitor_layout(compiled, {}, RustReadingCode)


@pytest.fixture(scope="module")
def esterle():
    return rulec.compile_rulebook("esterle2019", step_s=1)


def differs(library, n_states):
    return [text for part in proof_of(library, n_states) for text in part.differs]


@needs_rust
@given(seeds)
@settings(phases=[Phase.generate], max_examples=max(1, settings().max_examples // 100))
def test_random_rulebooks_are_proved(chance):
    step_s = Fraction(1)
    compiled = compile_here(rulebook(chance, step_s), step_s)
    bounds = chance.choice([{}, {"thing": 1}])
    layout = monitor_layout(compiled, bounds, RustReadingCode)
    assert differs(RustLibrary(layout, optimised=False), 60) == []


@needs_rust
@pytest.mark.long
@pytest.mark.parametrize("book", ["de", "gb", "un-r157", "us-ca"])
def test_shipped_rulebooks_are_proved(book):
    compiled = rulec.compile_rulebook(book, step_s=1)
    assert differs(RustLibrary(layout_of(compiled)), 60) == []


@needs_rust
def test_a_planted_fault_is_found(esterle):
    layout = layout_of(esterle)
    source = rust_source(layout)
    faulty, n = re.subn(r"(entries: &\[)(\d+)", lambda m: f"{m[1]}{int(m[2]) ^ 1}", source, count=1)
    assert n == 1
    assert differs(RustLibrary(layout, faulty, optimised=False), 20)


@pytest.fixture(scope="module")
def one_seat():
    compiled = rulec.compile_rulebook(rulec.parse_rulebook(SINCE), step_s=1)
    return RustLibrary(monitor_layout(compiled, {"car": 1}, RustReadingCode), optimised=False)


@needs_rust
def test_a_past_that_is_taken_for_known_is_found(one_seat):
    assert differs(one_seat, 2000) == []
    source = rust_source(one_seat.layout)
    faulty = source.replace("= kept.left_out[kind];", "= false;")
    assert faulty != source
    assert differs(RustLibrary(one_seat.layout, faulty, optimised=False), 2000)


@needs_rust
@pytest.mark.parametrize("ids", [[1, 2, 2], [1, 2, 1], [2, 1, 2]])
def test_who_is_given_twice_without_a_seat_is_refused(one_seat, ids):
    objects = (one_seat.object_type * 3)()
    for one, number in zip(objects, ids, strict=True):
        one.type, one.id = 0, number
    given = one_seat.input_type()
    given.n_objects, given.objects = 3, objects
    assert CMonitor(one_seat).take(given) == 3


@needs_rust
def test_a_rule_is_about_whoever_has_its_worst_verdict(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    book = rulec.compile_rulebook(rulec.parse_rulebook(BLAMED), step_s=1)
    rulec.write_monitor(book, tmp_path, {"car": 2}, language="rust")
    states = "".join(
        f"({p}, &[{', '.join(f'({car}, {q})' for car, q in cars.items())}]), "
        for p, cars, _ in WHO_IS_BLAMED
    )
    Path("who.rs").write_text(
        f"""
use blamed::{{names, Input, Monitor, Object}};
fn main() {{
    let mut monitor = Monitor::new();
    let states: [(u8, &[(u32, u8)]); {len(WHO_IS_BLAMED)}] = [{states}];
    for (p, cars) in states {{
        let mut objects = [Object::unknown(0, names::TYPE_CAR); 2];
        for (object, (id, q)) in objects.iter_mut().zip(cars) {{
            (object.id, object.q) = (*id, *q);
        }}
        let mut input = Input::unknown(&objects[..cars.len()]);
        input.p = p;
        monitor.step(&input).unwrap();
        println!("{{:?}} {{:?}}", monitor.about(0, 0), monitor.about(0, 1));
    }}
}}
"""
    )
    crate = ["--crate-type", "rlib", "--crate-name", "blamed", "src/lib.rs"]
    for arguments in (crate, ["who.rs", "--extern", "blamed=libblamed.rlib"]):
        subprocess.run(["rustc", "--edition", "2021", "-D", "warnings", *arguments], check=True)
    done = subprocess.run(["./who"], check=True, capture_output=True, text=True)
    assert done.stdout.splitlines() == [f"Some({number}) None" for *_, number in WHO_IS_BLAMED]


@needs_rust
@pytest.mark.parametrize("name", ["names", "std", "harness"])
def test_a_crate_is_called_unlike_what_it_is_compiled_with(name):
    text = f"rulebook {name}\nsignal p default false\nhard rule r {{ require always p }}\n"
    compiled = rulec.compile_rulebook(rulec.parse_rulebook(text), step_s=1)
    RustLibrary(layout_of(compiled), optimised=False)


@pytest.mark.parametrize("text", HOSTILE)
def test_a_literal_has_its_text(text):
    written = rust_string(text)
    assert re.fullmatch(r'"([ .,\-_()a-zA-Z0-9]|\\u\{[0-9a-f]+\})*"', written)
    found = re.sub(r"\\u\{([0-9a-f]+)\}", lambda x: chr(int(x[1], 16)), written[1:-1])
    assert found == text.encode("utf-8", "replace").decode() or "\udcff" in text


def test_a_hostile_rulebook_has_the_same_code(esterle):
    evil = " ".join(HOSTILE)
    rules = tuple(replace(rule, cite=evil, says=evil) for rule in esterle.rules)
    sources = (SourceFile(evil, evil),) * len(esterle.sources)
    book = replace(esterle, rules=rules, title=evil, law=evil, as_of=evil, sources=sources)
    codes = []
    for one in (esterle, book):
        source = re.sub(r"//[^\n]*", "", rust_source(layout_of(one)))
        codes.append(re.sub(r",?\s+", "", re.sub(r'"[^"]*"', '""', source)))
    assert codes[0] == codes[1]


@needs_rust
def test_the_page_leads_to_a_monitor_in_rust(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    page = PAGE.read_text(encoding="utf-8")
    ((program, shown),) = re.findall(
        r"^```rust\n(.*?)^```\n\n```console\n(.*?)^```$", page, re.MULTILINE | re.DOTALL
    )
    Path("watch.rs").write_text(program, encoding="utf-8")
    commands = re.findall(r"^\$ (.*)\n((?:[^$].*\n)*)", shown, re.MULTILINE)
    assert len(commands) == 4
    for command, printed in commands:
        if command.startswith("rulec "):
            assert main(command.split()[1:]) == 0
        else:
            strict = command.replace("rustc ", "rustc -D warnings ", 1).split()
            done = subprocess.run(strict, check=True, capture_output=True, text=True)
            assert done.stdout == printed
    assert printed == "false\nfalse\ntrue\n"


def test_fields_have_their_meaning():
    source = """
    rulebook units
    type car
    quantity gap(c: car) in m
    quantity speed in km/h default 3.5
    light is one of red, green default red
    signal follows(c: car, d: car) default false
    hard rule a (c: car, d: car) {
      require always (follows(c, d) and gap(c) > 2 m and speed < 3 m/s implies red)
    }
    """
    written = rust_source(layout_of(rulec.compile(rulec.parse_rulebook(source))))
    for comment, field in (
        ("`gap` of each car: in m", "gap: f64"),
        ("`speed`: in km/h, default 3.5", "speed: f64"),
        ("`light`: one of 2 values, default red", "light: u8"),
        ("`follows` of each car: signal, default false", "follows: Option<&'a [u8]>"),
    ):
        assert f"    /// {comment}\n    pub {field},\n" in written


@needs_cargo
@pytest.mark.long
def test_cargo_has_nothing_to_say(tmp_path):
    for book in ("esterle2019", "de"):
        rulec.write_monitor(book, tmp_path / book, language="rust")
        clippy = ["clippy", "--offline", "--quiet", "--", "-D", "warnings"]
        for arguments in (["test", "--offline", "--quiet"], clippy):
            done = subprocess.run(["cargo", *arguments], cwd=tmp_path / book, capture_output=True)
            assert done.returncode == 0, done.stderr.decode()


def test_a_word_may_be_called_like_a_constant():
    """Clippy wants no name twice in a field that has its constant's name."""
    source = "rulebook u\nsignal UNKNOWN default false\nhard rule a { require never UNKNOWN }"
    written = rust_source(layout_of(rulec.compile(rulec.parse_rulebook(source))))
    assert "UNKNOWN: UNKNOWN" not in written
    assert "Self { objects, UNKNOWN }" in " ".join(written.split())


def test_the_report_stands_beside_it(tmp_path):
    if shutil.which("rustc") is None:
        pytest.skip("there is no Rust compiler")
    arguments = ["compile", "esterle2019", "--emit", "rust", "--prove", "-o", str(tmp_path)]
    assert main(arguments) == 0
    report = (tmp_path / "esterle2019_proof.txt").read_text()
    assert report.startswith("monitor in Rust of esterle2019")
    assert report.count(": 0 differ\n") == 7
    assert (tmp_path / "src" / "lib.rs").exists()


def test_a_crate_needs_nothing(esterle):
    texts = crate_texts(layout_of(esterle))
    assert "dependencies" not in texts["Cargo.toml"]
    assert "#![no_std]\n#![forbid(unsafe_code)]\n" in texts["src/lib.rs"]


def in_rustfmts_form(*files):
    check = ["rustfmt", "--edition", "2021", "--check", "--color", "never", *files]
    done = subprocess.run(check, capture_output=True, text=True)
    return done.stdout + done.stderr


@needs_rustfmt
@pytest.mark.parametrize("book", ["esterle2019", "gb"])
def test_a_crate_is_in_rustfmts_form(book, tmp_path):
    rulec.write_monitor(book, tmp_path, language="rust")
    assert in_rustfmts_form(*tmp_path.rglob("*.rs")) == ""


@needs_rustfmt
@pytest.mark.long
@pytest.mark.parametrize("book", NATIONAL)
def test_all_that_ships_is_in_rustfmts_form(book, tmp_path):
    rulec.write_monitor(book, tmp_path, language="rust")
    assert in_rustfmts_form(*tmp_path.rglob("*.rs")) == ""


@needs_rustfmt
def test_long_names_are_in_rustfmts_form(tmp_path):
    name = "a" * 60
    book = rulec.parse_rulebook(
        f"rulebook {name}\ntype thing\nquantity {name}(a: thing, b: thing) in m default 1\n"
        "hard rule r (v: thing, w: thing) {\n"
        f"  require always ({name}(v, w) > {name}(w, v) or count x: thing ({name}(x, v) > 3 m) < 2)"
        "\n}\n"
    )
    rulec.write_monitor(book, tmp_path, language="rust")
    assert in_rustfmts_form(*tmp_path.rglob("*.rs")) == ""


TWENTY = ", ".join(map(str, range(20)))
TERM = "is(input.objects[who0].oncoming)"


@pytest.mark.parametrize(
    ("line", "expected"),
    [
        ("    // a[0, 1]", ["    // a[0, 1]"]),
        ("static A: [u8; 20] = [1, 2];", ["static A: [u8; 20] = [1, 2];"]),
        (
            f"static A: [u8; 20] = [{TWENTY}];",  # 70 columns of numbers, of which 60 may be
            ["static A: [u8; 20] = [", f"    {TWENTY},", "];"],
        ),
        ("    Self { id, kind: 12 }", ["    Self { id, kind: 12 }"]),  # 16 columns of 18
        (
            "    Self { id, kind: 12, x: 34 }",
            ["    Self {", "        id,", "        kind: 12,", "        x: 34,", "    }"],
        ),
        (
            f"    digits[1] = or({TERM}, {TERM});",
            ["    digits[1] = or(", f"        {TERM},", f"        {TERM},", "    );"],
        ),
        (
            f"    not(or({TERM}, {TERM}))",
            ["    not(or(", f"        {TERM},", f"        {TERM},", "    ))"],
        ),
        (
            "        0 => if who0 == each { YES } else { NO },",
            [
                "        0 => {",
                "            if who0 == each {",
                "                YES",
                "            } else {",
                "                NO",
                "            }",
                "        }",
            ],
        ),
    ],
)
def test_a_line_is_in_rustfmts_form(line, expected):
    assert list(formed([line])) == expected
