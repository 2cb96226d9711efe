"""Files that are made from others are those that would be made now."""

import pytest

from tools import regenerate

AGAIN = "run `.ci/task regenerate`, or `python -m tools.regenerate` with src on PYTHONPATH"


# The parser's tables name the release of Lark that made them; tests/syntax/test_tables.py has them.
@pytest.mark.parametrize("name", sorted(set(regenerate.GENERATED) - {"grammar/rulec.tables.json"}))
def test_a_generated_file_is_up_to_date(name):
    assert regenerate.is_current(name), AGAIN


@pytest.mark.spot
def test_what_is_out_of_date_is_named_then_written(tmp_path, monkeypatch, capsys):
    monkeypatch.setattr(regenerate, "ROOT", tmp_path)
    monkeypatch.setattr(regenerate, "GENERATED", {"docs/a.md": lambda: "new\n"})
    assert regenerate.main(["--check"]) == 1
    assert not (tmp_path / "docs").exists()
    assert regenerate.main([]) == 0
    assert (tmp_path / "docs/a.md").read_text() == "new\n"
    assert regenerate.main(["--check"]) == 0
    assert capsys.readouterr().out == "docs/a.md is out of date\nwrote docs/a.md\n"
