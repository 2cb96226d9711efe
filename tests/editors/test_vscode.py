"""The extension for Visual Studio Code: packed, unpacked, and run without the editor."""

import json
import re
import sys
import zipfile
from pathlib import Path

import pytest

import rulec
from rulec.syntax.keywords import RESERVED
from tools.release.parts import put_extension

ROOT = Path(__file__).resolve().parents[2]
CONTENT = {
    "extension.vsixmanifest",
    "[Content_Types].xml",
    "extension/package.json",
    "extension/language-configuration.json",
    "extension/readme.md",
    "extension/LICENSE.txt",
    "extension/dist/extension.js",
    "extension/syntaxes/rulec.tmLanguage.json",
}


def test_the_manifest_tells_how_a_rulebook_begins(editors):
    manifest = json.loads((editors / "vscode" / "package.json").read_text(encoding="utf-8"))
    assert manifest["version"] == rulec.__version__
    (language,) = manifest["contributes"]["languages"]
    begins = re.compile(language["firstLine"])
    assert begins.match("rulebook de")
    assert begins.match("  vocabulary road {")
    assert not begins.match("rulebooks of the world")


def test_the_configuration_knows_brackets_and_when_to_indent(editors):
    text = (editors / "vscode" / "language-configuration.json").read_text(encoding="utf-8")
    configuration = json.loads(text)
    assert configuration["brackets"] == [["{", "}"], ["[", "]"], ["(", ")"]]
    deeper = re.compile(configuration["indentationRules"]["increaseIndentPattern"])
    assert deeper.match("hard rule passing (v: vehicle) {")
    assert not deeper.match('  accept "stays" { b(v); b(v) }')
    assert not deeper.match("# as in {")
    assert re.match(configuration["indentationRules"]["decreaseIndentPattern"], "  }")


@pytest.mark.long
def test_the_extension_is_packed_by_one_command_and_starts_the_server(program, done, tmp_path):
    program("npm")
    archive = put_extension(tmp_path)
    assert archive.name == f"rulec-{rulec.__version__}.vsix"
    with zipfile.ZipFile(archive) as vsix:
        assert set(vsix.namelist()) == CONTENT
        vsix.extractall(tmp_path)
    folder = tmp_path / "extension"
    manifest = json.loads((folder / "package.json").read_text(encoding="utf-8"))
    assert (folder / manifest["main"]).is_file()
    (grammar,) = manifest["contributes"]["grammars"]
    highlighted = (folder / grammar["path"]).read_text(encoding="utf-8")
    assert all(word in highlighted for word in RESERVED)
    assert (folder / "LICENSE.txt").read_bytes() == (ROOT / "LICENSE").read_bytes()

    pytest.importorskip("pygls", reason="the server needs pygls")
    server, asked = tmp_path / "rulec", tmp_path / "asked"
    server.write_text(f'#!/bin/sh\necho "$@" > "{asked}"\nexec "{sys.executable}" -m rulec "$@"\n')
    server.chmod(0o755)
    activate = Path(__file__).with_name("activate_extension.js")
    assert done(program("node"), activate, folder / manifest["main"], server) == "started\n"
    assert asked.read_text() == "lsp\n"

    nowhere = tmp_path / "nowhere"
    said = done(program("node"), activate, folder / manifest["main"], nowhere)
    assert "pip install -e '.[lsp]'" in said
