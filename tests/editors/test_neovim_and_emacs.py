"""The lines for the settings of Neovim and Emacs, run in them with the real server."""

import json
import os
import re
import sys
from pathlib import Path

import pytest
from click.testing import CliRunner

from rulec.cli.commands.writing.lsp import EDITORS, command, editor_settings

ROOT = Path(__file__).resolve().parents[2]
PAGE = (ROOT / "docs" / "editors.md").read_text(encoding="utf-8")
PLACE = "/home/me/rulec"
"""A checkout, on the page."""
MISSPELT = """rulebook lane
use paper

hard rule no_passing (v: vehicle) {
  require always not (b(v) and eventually g(v))
}
"""
LOOK_IN_NEOVIM = """
vim.wait(120000, function() return #vim.diagnostic.get(0) > 0 end, 100)
for _, found in ipairs(vim.diagnostic.get(0)) do
  io.write(vim.bo.filetype, " ", found.lnum, " ", found.code, "\\n")
end
vim.cmd("qa!")
"""
LOOK_IN_EMACS = """
(require 'eglot)
(setq eglot-sync-connect 120)
(find-file "lane.rules")
(call-interactively #'eglot)
(let ((left 600))
  (while (and (> left 0) (null (flymake-diagnostics)))
    (setq left (1- left))
    (accept-process-output nil 0.2)
    (flymake-start nil)))
(dolist (found (flymake-diagnostics))
  (message "%s %s %s" major-mode (line-number-at-pos (flymake-diagnostic-beg found))
           (flymake-diagnostic-text found)))
(font-lock-ensure)
(goto-char (point-min))
(search-forward "no_pass")
(message "%s" (get-text-property (point) 'face))
"""


EDITOR = {"lua": "neovim", "elisp": "emacs"}


def settings(editor):
    """What `rulec lsp --settings` prints for an editor."""
    printed = CliRunner().invoke(command, ["--settings", editor])
    assert printed.exit_code == 0, printed.output
    return printed.output


@pytest.mark.parametrize("language", EDITOR)
def test_an_editor_takes_three_lines_which_the_page_shows(language, monkeypatch):
    (block,) = re.findall(rf"^  ```{language}\n(.*?)^  ```", PAGE, re.MULTILINE | re.DOTALL)
    shown = re.sub("^  ", "", block, flags=re.MULTILINE)
    python = Path(sys.executable)
    home = shown.replace(f"{PLACE}/.venv/bin", str(python.parent)).replace(PLACE, str(ROOT))
    assert settings(EDITOR[language]) == home
    assert len(home.splitlines()) == 3


@pytest.mark.parametrize("editor", EDITORS)
def test_settings_are_printed_before_what_the_server_takes_is_installed(editor, monkeypatch):
    for name in ("pygls", "lsprotocol", "lsprotocol.types", "pygls.lsp.server"):
        monkeypatch.setitem(sys.modules, name, None)
    monkeypatch.delitem(sys.modules, "rulec.language_server.server", raising=False)
    assert settings(editor) == editor_settings(editor)


def test_where_there_is_no_script_python_starts_it(monkeypatch, tmp_path):
    monkeypatch.setattr(sys, "executable", str(tmp_path / 'my "own"' / "python"))
    told = dict(re.findall(r"^(command|args) = (.*)$", editor_settings("helix"), re.MULTILINE))
    # Strings and lists are written in TOML as in JSON.
    assert json.loads(told["command"]) == sys.executable
    assert json.loads(told["args"]) == ["-m", "rulec", "lsp"]
    told = json.loads("{" + editor_settings("vscode") + "}")
    assert told == {"rulec.command": [sys.executable, "-m", "rulec"]}


@pytest.fixture
def project(tmp_path):
    """A folder with a rulebook that has a mistake, and the environment to look at it."""
    folder = tmp_path / "project"
    folder.mkdir()
    (folder / "rulec.toml").touch()
    (folder / "lane.rules").write_text(MISSPELT)
    return folder, {
        **os.environ,
        "HOME": str(tmp_path),
        "XDG_STATE_HOME": str(tmp_path),
    }


@pytest.mark.long
def test_neovim_shows_a_mistake(project, program, done):
    folder, environment = project
    neovim = program("nvim")
    if re.match(r"NVIM v0\.[0-7]\.", done(neovim, "--version")):
        pytest.skip("Neovim is older than 0.8")
    (folder / "init.lua").write_text(settings("neovim"))
    (folder / "look.lua").write_text(LOOK_IN_NEOVIM)
    command = (neovim, "--headless", "-u", "init.lua", "lane.rules", "-S", "look.lua")
    assert "rulec 4 R0202" in done(*command, cwd=folder, env=environment)


@pytest.mark.long
def test_emacs_shows_a_mistake_and_highlights(project, program, done):
    folder, environment = project
    emacs = program("emacs")
    if "nil" in done(emacs, "--batch", "--eval", '(princ (locate-library "eglot"))'):
        pytest.skip("Emacs has no eglot")
    (folder / "init.el").write_text(settings("emacs"))
    (folder / "look.el").write_text(LOOK_IN_EMACS)
    told = done(emacs, "--batch", "-l", "init.el", "-l", "look.el", cwd=folder, env=environment)
    assert re.search(r"^rulec-mode 5 .*R0202", told, re.MULTILINE)
    assert "font-lock-function-name-face" in told
