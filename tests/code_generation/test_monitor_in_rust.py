"""A crate of Rust around the monitor in C: the same verdicts, and what cargo says."""

import os
import re
import shutil
import subprocess
from dataclasses import replace
from pathlib import Path
from random import Random

import pytest

import rulec
from rulec.cli.main import main
from rulec.code_generation.compiled_c.c_library import CLibrary, CMonitor
from rulec.code_generation.monitor_files import monitor_texts
from rulec.code_generation.monitor_layout import VERDICTS, monitor_layout
from rulec.code_generation.rust_files import crate_texts, rust_source
from rulec.code_generation.written_names import rust_string
from rulec.monitoring.online.four_valued import best_of, worst_of
from rulec.rulebook.rulebook_model import SourceFile
from rulec.vocabulary.partial_values import UNKNOWN
from support.builders.monitored_books import BLAMED, WHO_IS_BLAMED

needs_cargo = pytest.mark.skipif(shutil.which("cargo") is None, reason="there is no cargo")
PAGE = Path(__file__).parents[2] / "docs" / "online.md"
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
    return monitor_layout(compiled, {})


@pytest.fixture(scope="module")
def esterle():
    return rulec.compile_rulebook("esterle2019", step_s=1)


def said_by(crate, program, tmp_path):
    """What a program prints that depends on a crate; the crate is in `monitor`."""
    manifest = (
        '[package]\nname = "watch"\nversion = "0.1.0"\nedition = "2021"\n'
        f'[dependencies]\n{crate} = {{ path = "monitor" }}\n'
    )
    (tmp_path / "Cargo.toml").write_text(manifest)
    (tmp_path / "src").mkdir()
    (tmp_path / "src" / "main.rs").write_text(program)
    done = subprocess.run(
        ["cargo", "run", "--offline", "--quiet"], cwd=tmp_path, capture_output=True, text=True
    )
    assert done.returncode == 0, done.stderr
    return done.stdout.splitlines()


@needs_cargo
def test_a_rule_is_about_whoever_has_its_worst_verdict(tmp_path):
    book = rulec.compile_rulebook(rulec.parse_rulebook(BLAMED), step_s=1)
    rulec.write_monitor(book, tmp_path / "monitor", {"car": 2}, language="rust")
    states = "".join(
        f"({p}, &[{', '.join(f'({car}, {q})' for car, q in cars.items())}]), "
        for p, cars, _ in WHO_IS_BLAMED
    )
    program = f"""
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
    expected = [f"Some({number}) None" for *_, number in WHO_IS_BLAMED]
    assert said_by("blamed", program, tmp_path) == expected


MIXED = """rulebook mixed
type car
signal wet
light is one of red, green default red
quantity speed(c: car) in m/s
quantity gap(c: car, d: car) in m default 9
hard rule far (c: car, d: car) {
  require always (gap(c, d) < 5 m and speed(c) > 3 m/s implies next gap(c, d) >= 5 m)
}
soft rule wait (c: car) { require always (red and not wet implies speed(c) < 1 m/s) }
"""


@needs_cargo
def test_a_crate_says_what_the_monitor_in_c_says(tmp_path):
    """Values of every kind, known and unknown, about the world, one object and two."""
    book = rulec.compile_rulebook(rulec.parse_rulebook(MIXED), step_s=1)
    rulec.write_monitor(book, tmp_path / "monitor", {"car": 3}, language="rust")
    chance, monitor = Random(5), CMonitor(CLibrary(monitor_layout(book, {"car": 3})))
    steps, expected = [], []
    for _ in range(40):
        cars = chance.sample(["1", "2", "3"], chance.randint(0, 3))
        wet, light = chance.choice([0, 1, 255]), chance.choice([0, 1, 255])
        speeds = {car: chance.choice([0.5, 2.0, 4.0, None]) for car in cars}
        gaps = {car: {of: chance.choice([3.0, 7.0, None]) for of in cars} for car in cars}
        state = {
            "wet": UNKNOWN if wet == 255 else bool(wet),
            "light": UNKNOWN if light == 255 else ("red", "green")[light],
            "speed": {car: UNKNOWN if own is None else own for car, own in speeds.items()},
            "gap": {
                car: {of: UNKNOWN if own is None else own for of, own in all_own.items()}
                for car, all_own in gaps.items()
            },
        }
        answer = monitor.step(state, dict.fromkeys(cars, "car"))
        numbers = [answer.verdict, *answer.rules.values()]
        expected.append(" ".join(f"{ORDER[best_of(one)]}{ORDER[worst_of(one)]}" for one in numbers))
        objects = ", ".join(f"({monitor_id(monitor, car)}, {number(speeds[car])})" for car in cars)
        pairs = ", ".join(number(gaps[car][of]) for car in cars for of in cars)
        steps.append(f"({wet}, {light}, &[{objects}], &[{pairs}]), ")
    program = f"""
use mixed::{{names, Input, Monitor, Object}};
fn main() {{
    let mut monitor = Monitor::new();
    let steps: [(u8, u8, &[(u32, f64)], &[f64]); {len(steps)}] = [{"".join(steps)}];
    for (wet, light, cars, gaps) in steps {{
        let mut objects = [Object::unknown(0, names::TYPE_CAR); 3];
        for (object, (id, speed)) in objects.iter_mut().zip(cars) {{
            (object.id, object.speed) = (*id, *speed);
        }}
        let mut input = Input::unknown(&objects[..cars.len()]);
        (input.wet, input.light, input.gap) = (wet, light, Some(gaps));
        let said = monitor.step(&input).unwrap();
        let all: Vec<String> = [said.book].iter().chain(said.rules.iter())
            .map(|one| format!("{{}}{{}}", one.best as u8, one.worst as u8)).collect();
        println!("{{}}", all.join(" "));
    }}
    let mut twice = [Object::unknown(1, names::TYPE_CAR); 2];
    println!("{{:?}}", monitor.step(&Input::unknown(&twice)));
    (twice[1].id, twice[1].r#type) = (2, 9);
    println!("{{:?}}", monitor.step(&Input::unknown(&twice)));
    let mut short = Input::unknown(&twice);
    short.gap = Some(&[1.0]);
    println!("{{:?}}", monitor.step(&short));
}}
"""
    *said, first, second, third = said_by("mixed", program, tmp_path)
    assert said == expected
    assert len(set(said)) > 4
    assert [first, second, third] == ["Err(Twice)", "Err(BadType)", "Err(TooMany)"]


ORDER = {verdict: number for number, verdict in enumerate(VERDICTS)}


def monitor_id(monitor, car):
    return monitor._ids[car]


def number(value):
    return "f64::NAN" if value is None else repr(value)


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


@needs_cargo
def test_the_page_leads_to_a_monitor_in_rust(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    page = PAGE.read_text(encoding="utf-8")
    ((program, manifest, shown),) = re.findall(
        r"^```rust\n(.*?)^```\n\n```toml\n(.*?)^```\n\n```console\n(.*?)^```$",
        page,
        re.MULTILINE | re.DOTALL,
    )
    Path("src").mkdir()
    Path("src/main.rs").write_text(program, encoding="utf-8")
    Path("Cargo.toml").write_text(manifest, encoding="utf-8")
    compiling, running = re.findall(r"^\$ (.*)\n((?:[^$].*\n)*)", shown, re.MULTILINE)
    assert main(compiling[0].split()[1:]) == 0
    written = [line.removeprefix("wrote ") for line in compiling[1].splitlines()]
    assert all(map(os.path.exists, written))
    assert len(written) == sum(path.is_file() for path in Path("monitor").rglob("*"))
    offline = [*running[0].split(), "--offline"]
    done = subprocess.run(offline, check=True, capture_output=True, text=True)
    assert done.stdout == running[1] == "false\nfalse\ntrue\n"


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
    arguments = ["compile", "esterle2019", "--emit", "rust", "--prove", "-o", str(tmp_path)]
    assert main(arguments) == 0
    report = (tmp_path / "esterle2019_proof.txt").read_text()
    assert report.startswith("monitor in C of esterle2019")
    assert report.count(": 0 differ\n") == 7
    assert (tmp_path / "src" / "lib.rs").exists()


def test_a_crate_needs_nothing_but_the_c(esterle):
    texts = crate_texts(layout_of(esterle))
    assert "dependencies" not in texts["Cargo.toml"]
    assert "#![no_std]\n" in texts["src/lib.rs"]
    in_c = monitor_texts(layout_of(esterle))
    for name in ("esterle2019.c", "esterle2019.h"):
        assert texts[f"c/{name}"] == in_c[name]
