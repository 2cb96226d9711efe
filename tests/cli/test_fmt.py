"""``rulec fmt`` as its user meets it."""

import io
import os
import pty
import stat
import subprocess
import sys
from pathlib import Path

import pytest

from rulec.cli.main import main
from rulec.syntax.formatting import safe_format

GOOD = "rulebook good\nsignal p\nhard rule r { require always p }\n"
UGLY = "rulebook good   signal p\nhard rule r {require always p }"
WRONG = "rulebook wrong\nsignal p\nhard rule r { require p p }\n"
RULEC = [sys.executable, "-c", "from rulec.cli.main import main; raise SystemExit(main())"]


@pytest.fixture
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "good.rules").write_text(GOOD)
    (tmp_path / "ugly.rules").write_text(UGLY)
    return tmp_path


def fmt(capsys, *arguments):
    status = main(["fmt", *arguments])
    return status, *capsys.readouterr()


def as_input(monkeypatch, data):
    monkeypatch.setattr(sys, "stdin", io.TextIOWrapper(io.BytesIO(data)))


def test_files_are_rewritten_in_place(folder, capsys):
    assert fmt(capsys, "good.rules", "ugly.rules") == (
        0,
        "",
        "1 file changed, 1 file already formatted\n",
    )
    assert (folder / "ugly.rules").read_text() == GOOD
    assert fmt(capsys, "ugly.rules", "./ugly.rules") == (0, "", "1 file already formatted\n")


def test_without_paths_it_is_the_working_folder(folder, capsys):
    (folder / "inner").mkdir()
    (folder / "inner" / "another.rules").write_text(UGLY)
    (folder / ".hidden").mkdir()
    (folder / ".hidden" / "third.rules").write_text(UGLY)
    assert fmt(capsys) == (0, "", "2 files changed, 1 file already formatted\n")
    assert (folder / "inner" / "another.rules").read_text() == GOOD
    assert (folder / ".hidden" / "third.rules").read_text() == UGLY


def test_a_file_that_is_in_form_is_not_written(folder, capsys):
    before = (folder / "good.rules").stat()
    assert fmt(capsys, "good.rules")[0] == 0
    after = (folder / "good.rules").stat()
    assert (before.st_ino, before.st_mtime_ns) == (after.st_ino, after.st_mtime_ns)


def test_check_names_files_and_writes_nothing(folder, capsys):
    assert fmt(capsys, "--check") == (
        1,
        "would change ugly.rules\n",
        "1 file would change, 1 file already formatted\n",
    )
    assert (folder / "ugly.rules").read_text() == UGLY
    assert fmt(capsys, "--check", "good.rules") == (0, "", "1 file already formatted\n")


def test_diff_can_be_applied(folder, capsys):
    status, out, err = fmt(capsys, "--diff")
    assert (status, err) == (1, "1 file would change, 1 file already formatted\n")
    assert out == (
        "--- ugly.rules\n"
        "+++ ugly.rules\n"
        "@@ -1,2 +1,3 @@\n"
        "-rulebook good   signal p\n"
        "-hard rule r {require always p }\n"
        "\\ No newline at end of file\n"
        "+rulebook good\n"
        "+signal p\n"
        "+hard rule r { require always p }\n"
    )
    assert (folder / "ugly.rules").read_text() == UGLY
    assert fmt(capsys, "--diff", "good.rules")[:2] == (0, "")


@pytest.mark.parametrize(("environment", "colored"), [({}, True), ({"NO_COLOR": "1"}, False)])
def test_a_diff_has_colour_on_a_terminal_only(folder, environment, colored):
    (folder / "hostile.rules").write_text(f"{GOOD}#  x \n")
    mine, theirs = pty.openpty()
    clean = {name: text for name, text in os.environ.items() if name != "NO_COLOR"}
    subprocess.run(
        [*RULEC, "fmt", "--diff", "hostile.rules"],
        stdout=theirs,
        stderr=subprocess.DEVNULL,
        env={**clean, **environment},
        check=False,
    )
    os.close(theirs)
    shown = os.read(mine, 10_000).decode()
    os.close(mine)
    assert ("\x1b[31m-#  x" in shown) is colored
    assert ("\x1b[" in shown) is colored
    assert "-#  x" in shown


def test_a_comment_that_drives_a_terminal_is_no_diff(folder, capsys):
    (folder / "hostile.rules").write_text(f"{GOOD}#  \x1b[2J \n")
    status, out, err = fmt(capsys, "--diff", "hostile.rules")
    assert (status, out) == (2, "")
    assert "error[R0118]" in err
    assert "\x1b" not in err


@pytest.mark.parametrize(
    "data",
    [GOOD.replace("\n", "\r\n").encode(), b"\xef\xbb\xbf" + GOOD.encode(), GOOD[:-1].encode()],
)
def test_line_ends_byte_order_marks_and_the_final_line_end(data, folder, capsys):
    (folder / "good.rules").write_bytes(data)
    assert fmt(capsys, "--check", "good.rules")[0] == 1
    assert fmt(capsys, "--diff", "good.rules")[0] == 1
    assert fmt(capsys, "good.rules")[0] == 0
    assert (folder / "good.rules").read_bytes() == GOOD.encode()


def test_mistakes_leave_a_file_alone_and_others_go_on(folder, capsys):
    (folder / "a_wrong.rules").write_text(WRONG)
    status, out, err = fmt(capsys)
    assert (status, out) == (2, "")
    assert "error[R0104]" in err
    assert "--> a_wrong.rules:3:25" in err
    assert err.endswith("1 file changed, 1 file already formatted\n")
    assert (folder / "a_wrong.rules").read_text() == WRONG
    assert (folder / "ugly.rules").read_text() == GOOD
    assert fmt(capsys, "--check")[0] == 2


def test_what_a_name_means_nowhere_matters_not(folder, capsys):
    """Spelling is enough: a vocabulary that is not there yet is no reason not to format."""
    (folder / "good.rules").write_text(GOOD.replace("signal p", "use nowhere"))
    assert fmt(capsys, "good.rules")[0] == 0


@pytest.mark.parametrize("pattern", ["next[1e9 steps]", "no*such"])
def test_a_pattern_that_nothing_is_called_like(pattern, folder, capsys):
    status, _, err = fmt(capsys, pattern)
    assert status == 2
    assert "R0733" in err


@pytest.mark.parametrize(
    "name", ["plain.rules", "with blanks.rules", "über.rules", "a\nb.rules", "##[error]x.rules"]
)
def test_patch_applies_a_diff_whatever_the_file_is_called(tmp_path, monkeypatch, capsys, name):
    monkeypatch.chdir(tmp_path)
    file = Path(name)
    file.write_text(UGLY)
    status, out, _ = fmt(capsys, "--diff", f"./{name}")
    assert status == 1
    subprocess.run(["patch", "-p0"], input=out.encode(), check=True, capture_output=True)
    assert file.read_text() == GOOD


def test_standard_input(folder, capsys, monkeypatch):
    as_input(monkeypatch, UGLY.encode())
    assert fmt(capsys, "-") == (0, GOOD, "")
    as_input(monkeypatch, UGLY.encode())
    assert fmt(capsys, "-", "--check") == (1, "would change standard input\n", "")
    as_input(monkeypatch, UGLY.encode())
    status, out, _ = fmt(capsys, "-", "--diff")
    assert status == 1
    assert out.startswith("--- standard input\t\n+++ standard input\t\n")
    as_input(monkeypatch, GOOD.encode())
    assert fmt(capsys, "-", "--check") == (0, "", "")
    as_input(monkeypatch, WRONG.encode())
    status, out, err = fmt(capsys, "-")
    assert (status, out) == (2, "")
    assert "--> standard input:3:25" in err


def test_standard_input_stays_utf_8_whatever_the_terminal_speaks():
    text = GOOD.replace("require p", 'says "Überholen, 車" require p')
    done = subprocess.run(
        [*RULEC, "fmt", "-"],
        input=text.encode(),
        capture_output=True,
        env={**os.environ, "PYTHONIOENCODING": "ascii"},
        check=False,
    )
    assert (done.returncode, done.stdout) == (0, text.encode())


def test_standard_input_is_given_alone(folder, capsys):
    status, _, err = fmt(capsys, "-", "ugly.rules")
    assert status == 2
    assert "cannot be combined with files" in err
    assert (folder / "ugly.rules").read_text() == UGLY


def test_permissions_and_links_stay(folder, capsys):
    file = folder / "ugly.rules"
    file.chmod(0o640)
    link = folder / "link.rules"
    link.symlink_to(file)
    assert fmt(capsys, "link.rules")[0] == 0
    assert link.is_symlink()
    assert file.read_text() == GOOD
    assert stat.S_IMODE(file.stat().st_mode) == 0o640
    assert sorted(path.name for path in folder.iterdir()) == [
        *("good.rules", "link.rules", "ugly.rules")
    ]


def test_a_file_that_may_not_be_written_is_named(folder, capsys, monkeypatch):
    (folder / "z.rules").write_text(UGLY)
    denied = os.path.realpath(folder / "ugly.rules")
    real = os.access
    monkeypatch.setattr(
        os, "access", lambda path, mode: os.path.realpath(path) != denied and real(path, mode)
    )
    status, _, err = fmt(capsys)
    assert status == 2
    assert "error[R0702]: the file cannot be written: permission denied" in err
    assert err.endswith("\n1 file changed, 1 file already formatted\n")
    assert (folder / "ugly.rules").read_text() == UGLY
    assert (folder / "z.rules").read_text() == GOOD


def test_a_pipe_is_no_file_to_rewrite(folder, capsys):
    reading, writing = os.pipe()
    os.write(writing, UGLY.encode())
    os.close(writing)
    status, out, err = fmt(capsys, f"/dev/fd/{reading}")
    os.close(reading)
    assert (status, out) == (2, "")
    assert "not a regular file" in err


@pytest.mark.parametrize(
    ("path", "code", "words"),
    [
        ("nowhere.rules", "R0701", "no such file"),
        ("nowhere", "R0701", "no such file"),
        ("esterle2019", "R0701", "give the path that it stands for"),
        ("empty", "R0733", "there is no rulebook and no vocabulary in this folder"),
    ],
)
def test_paths_that_lead_nowhere(path, code, words, folder, capsys):
    (folder / "empty").mkdir()
    status, out, err = fmt(capsys, path)
    assert (status, out) == (2, "")
    assert f"error[{code}]" in err
    assert words in err


def test_a_file_in_another_encoding(folder, capsys):
    (folder / "latin.rules").write_bytes(GOOD.replace("p", "ü").encode("latin-1"))
    assert fmt(capsys, "latin.rules")[0] == 2


def test_nothing_is_written_if_the_formatter_is_wrong(folder, capsys, monkeypatch):
    (folder / "z.rules").write_text(f"{UGLY}\nsignal q")
    real = safe_format.arranged
    monkeypatch.setattr(safe_format, "arranged", lambda source: real(source).replace(" q", " r"))
    status, out, err = fmt(capsys)
    assert (status, out) == (70, "")
    assert "this is a bug in rulec" in err
    assert "formatting would change what z.rules means" in err
    assert (folder / "ugly.rules").read_text() == UGLY
