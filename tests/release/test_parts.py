"""The parts of a release, and what the checkout has for those who come to it."""

import json
import re
import subprocess
import sys

from tools.programs import ROOT
from tools.release import __main__ as release
from tools.release.parts import put_checksums, site_overview

OVERVIEW = (ROOT / "llms.txt").read_text(encoding="utf-8")


def test_digests_are_checked_by_the_usual_program(tmp_path):
    (tmp_path / "site").mkdir()
    (tmp_path / "rulec.whl").write_bytes(b"wheel")
    put_checksums(tmp_path)
    put_checksums(tmp_path)
    check = ["sha256sum", "--check", "SHA256SUMS"]
    done = subprocess.run(check, cwd=tmp_path, capture_output=True, text=True, check=True)
    assert done.stdout == "rulec.whl: OK\n"
    (tmp_path / "rulec.whl").write_bytes(b"another")
    assert subprocess.run(check, cwd=tmp_path, capture_output=True, check=False).returncode == 1


def test_every_page_of_the_overview_is_there():
    pages = re.findall(r"\]\((.*?)\)", OVERVIEW)
    assert len(pages) > 10
    for page in pages:
        assert (ROOT / page).is_file(), page


def test_the_overview_of_the_site_leads_to_its_pages():
    names = re.findall(r"\(docs/(.*?)\.md\)", OVERVIEW)
    assert re.findall(r"\]\((.*?)\)", site_overview(OVERVIEW)) == [f"{name}.html" for name in names]


def test_the_container_for_development_begins_with_the_launcher():
    container = json.loads((ROOT / ".devcontainer/devcontainer.json").read_text(encoding="utf-8"))
    assert container["postCreateCommand"] == "RULEC_SET_UP=test ./rulec"
    assert container["image"].rpartition(":")[2] == "3.12"


def test_a_folder_with_other_files_is_left_alone(tmp_path, monkeypatch, capsys):
    (tmp_path / "letters.txt").write_text("dear all")
    monkeypatch.setattr(sys, "argv", ["release", "-o", str(tmp_path)])
    assert release.main() == 2
    assert "contains other files" in capsys.readouterr().err
    assert [path.name for path in tmp_path.iterdir()] == ["letters.txt"]


def test_what_is_wrong_is_told_and_fails(tmp_path, monkeypatch, capsys):
    monkeypatch.setattr(sys, "argv", ["release", "-o", str(tmp_path / "new")])
    monkeypatch.setattr(release, "build", lambda *_: None)
    monkeypatch.setattr(release, "faults_of", lambda *_: ["no light", "no door"])
    assert release.main() == 1
    said = capsys.readouterr().out
    assert "fault: no light\nfault: no door\n" in said
    assert said.endswith("is not fit for release: 2 faults\n")
    monkeypatch.setattr(release, "faults_of", lambda *_: [])
    assert release.main() == 0
