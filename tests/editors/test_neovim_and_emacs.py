"""The lines that the documentation gives for Neovim and Emacs, run in them with the real server."""

import os
import re
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
PAGE = (ROOT / "docs" / "editors.md").read_text(encoding="utf-8")
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


def lines(language):
    """The lines of the page's first block in a language, for a rulec on the path."""
    block, *_ = re.findall(rf"^  ```{language}\n(.*?)^  ```", PAGE, re.MULTILINE | re.DOTALL)
    on_path = block.replace("/home/me/rulec/.venv/bin/", "")
    return on_path.replace("\n  ", "\n").strip().splitlines()


@pytest.mark.parametrize("language", ["lua", "elisp"])
def test_an_editor_takes_three_lines(language):
    assert len(lines(language)) == 3


@pytest.fixture
def project(tmp_path, rulec_on_path):
    """A folder with a rulebook that has a mistake, and the environment to look at it."""
    pytest.importorskip("pygls", reason="the server needs pygls")
    folder = tmp_path / "project"
    folder.mkdir()
    (folder / "rulec.toml").touch()
    (folder / "lane.rules").write_text(MISSPELT)
    path = f"{rulec_on_path}:{os.environ['PATH']}"
    return folder, {
        **os.environ,
        "PATH": path,
        "HOME": str(tmp_path),
        "XDG_STATE_HOME": str(tmp_path),
    }


@pytest.mark.long
def test_neovim_shows_a_mistake(project, program, done):
    folder, environment = project
    neovim = program("nvim")
    if re.match(r"NVIM v0\.(\d|10)\.", done(neovim, "--version")):
        pytest.skip("Neovim is older than 0.11")
    (folder / "init.lua").write_text("\n".join(lines("lua")))
    (folder / "look.lua").write_text(LOOK_IN_NEOVIM)
    command = (neovim, "--headless", "-u", "init.lua", "lane.rules", "-S", "look.lua")
    assert "rulec 4 R0202" in done(*command, cwd=folder, env=environment)


@pytest.mark.long
def test_emacs_shows_a_mistake_and_highlights(project, program, done):
    folder, environment = project
    emacs = program("emacs")
    if "nil" in done(emacs, "--batch", "--eval", '(princ (locate-library "eglot"))'):
        pytest.skip("Emacs has no eglot")
    mode = ROOT / "src/editors/emacs/rulec-mode.el"
    text = "\n".join(lines("elisp")).replace("rulec-mode.el", str(mode))
    (folder / "init.el").write_text(text)
    (folder / "look.el").write_text(LOOK_IN_EMACS)
    told = done(emacs, "--batch", "-l", "init.el", "-l", "look.el", cwd=folder, env=environment)
    assert re.search(r"^rulec-mode 5 .*R0202", told, re.MULTILINE)
    assert "font-lock-function-name-face" in told
