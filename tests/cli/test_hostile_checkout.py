"""A stranger's checkout, through the three commands of docs/automation.md."""

import json
import os
import re
import shlex
import subprocess
import sys
from pathlib import Path

import pytest

from rulec.cli.main import main

ROOT = Path(__file__).parents[2]
SECRET = "hunter2-of-the-deploy-key"
BOOK = (
    "rulebook atlantis\ntype car\n"
    "signal stopped(c: car) default false\nsignal beside(a: car, b: car) default false\n"
    "hard rule crowd (a: car, b: car, c: car, d: car, e: car, f: car) {\n"
    "  require always not (\n"
    "    beside(a, b) and beside(b, c) and beside(c, d) and beside(d, e) and stopped(f)\n"
    "  )\n"
    "  accept  { stopped(f) }\n"
    "}\n"
)
COMMANDS = [
    shlex.split(line.split("#")[0])[1:]
    for line in re.search(r"```sh\n(.*?)```", (ROOT / "docs/automation.md").read_text(), re.S)[1]
    .strip()
    .splitlines()
]
OWN = re.compile(r"^::(?:error|warning) (?:file=[^\n:]*,)?title=R\d{4}[^\n]*$", re.MULTILINE)
COMMAND = re.compile(r"^\s*::(?!: )|##\[|##vso\[|##teamcity\[", re.MULTILINE)
CONTROL = re.compile("[\x00-\x08\x0b-\x1f\x7f-\x9f\u061c\u200e\u200f\u202a-\u202e\u2066-\u2069]")


def test_the_page_has_three_commands():
    assert [command[0] for command in COMMANDS] == ["fmt", "check", "test"]


@pytest.fixture
def checkout(tmp_path):
    (tmp_path / "secret.netrc").write_text(f"machine x password {SECRET}\n")
    (tmp_path / "victim.rules").write_text(f"rulebook   victim # {SECRET}\n")
    top = tmp_path / "checkout"
    books = top / "rulebooks"
    books.mkdir(parents=True)
    (top / ".git").mkdir()
    (top / "rulec.toml").write_text('search_path = ["rulebooks"]\n')
    (books / "atlantis.rules").write_text(BOOK)
    for name, target in {
        "environ.rules": "/proc/self/environ",
        "netrc.rules": "../../secret.netrc",
        "victim.rules": "../../victim.rules",
        "zero.rules": "/dev/zero",
        "loop.rules": "loop.rules",
        "elsewhere": "/etc",
    }.items():
        (books / name).symlink_to(target)
    os.mkfifo(books / "pipe.rules")
    hostile = "a\n::error::x\n##[group]\x1b]0;y\x07\u202e"
    (books / f"{hostile}.rules").write_text(f"{BOOK}# \u202e }} hard rule z {{ \x1b[2J\n")
    (books / f"b{hostile}.rules").write_text(f'rulebook b title "{hostile}"\n{hostile}\n')
    (books / os.fsdecode(b"\xff.rules")).write_bytes(b"rulebook \xff\n::warning::z\n")
    (books / "lookalike.rules").write_text(BOOK.replace("stopped(f)", "ѕtopped(f)"))
    (books / "binary.rules").write_bytes(b"\0" * 100 + SECRET.encode())
    (books / ".gitignore").write_text("*a" * 500 + "b\n" + "**/a/" * 100 + "\n")
    cache = top / "cache"
    cache.mkdir()
    for n in range(20):
        (cache / f"{n:040x}.json").write_text("[" * 50_000)
    (cache / ("f" * 40 + ".json")).write_text(json.dumps({"stamp": [], "findings": []}))
    return top


def run(checkout, command):
    return subprocess.run(
        [sys.executable, "-m", "rulec", *command],
        cwd=checkout,
        capture_output=True,
        check=False,
        timeout=120,
        env={**os.environ, "DEPLOY_KEY": SECRET, "RULEC_CACHE_DIR": str(checkout / "cache")},
    )


def test_it_shows_nothing_from_elsewhere_and_commands_nobody(checkout):
    codes = []
    for command in [*COMMANDS, ["fmt", "rulebooks"]]:
        done = run(checkout, command)
        for text in (done.stdout.decode(), done.stderr.decode()):
            assert SECRET not in text
            assert CONTROL.findall(text) == []
            assert COMMAND.findall(OWN.sub("", text)) == []
            codes += re.findall(r"R0\d{3}", text)
        assert done.returncode in (1, 2)
    assert {"R0118", "R0730", "R0731"} <= set(codes)
    assert (checkout.parent / "victim.rules").read_text().startswith("rulebook   victim")


@pytest.mark.parametrize("target", ["../secret.netrc", "/proc/self/environ"])
def test_settings_that_are_a_link_stop_every_command(target, checkout):
    (checkout / "rulec.toml").unlink()
    (checkout / "rulec.toml").symlink_to(target)
    for command in COMMANDS[:2]:
        done = run(checkout, command)
        assert done.returncode == 2
        assert b"R0730" in done.stderr
        assert SECRET.encode() not in done.stdout + done.stderr


LINKED = {
    "environment": f"HOME=/\0KEY={SECRET}\0",
    "assignments": f"HOME=/\nKEY={SECRET}\n",
    "a word": SECRET,
    "a table": f"trace,step,key\na,0,{SECRET}\n",
    "JSON that is cut": f'{{"key": "{SECRET}",',
    "TOML": f'key = "{SECRET}"\n',
    "YAML": f"key: {SECRET}\n",
}
READING = [
    ["verify", "link", "-r", "atlantis"],
    ["verify", "link*", "-r", "atlantis"],
    ["find", "stopped", "link", "-r", "atlantis"],
    ["maneuvers", "link", "-r", "esterle2019"],
    ["maneuvers", "s1", "-r", "esterle2019", "--after", "link"],
    ["draw", "scene", "link", "-o", "scene.svg"],
    ["draw", "trace", "link", "-r", "atlantis", "-o", "trace.svg"],
    ["show", "--audit", "rulebooks/atlantis.rules", "--law", "link"],
    ["show", "--audit", "rulebooks/atlantis.rules", "--compare", "link"],
    ["monitor", "atlantis", "--restore", "link"],
    ["compile", "--check", "link"],
    ["rates", "link"],
]


@pytest.mark.parametrize("content", LINKED)
def test_no_line_behind_a_link_out_of_the_tree_is_quoted(content, checkout, monkeypatch, capsys):
    (checkout.parent / "secret.txt").write_text(LINKED[content])
    for name in ("link", "link.jsonl", "link.csv", "link.toml"):
        (checkout / name).symlink_to("../secret.txt")
    monkeypatch.chdir(checkout)
    for words in READING:
        for name in ("link", "link.jsonl", "link.csv", "link.toml"):
            assert main([name if word == "link" else word for word in words]) == 2
            said = "".join(capsys.readouterr())
            assert SECRET not in said
            assert said
