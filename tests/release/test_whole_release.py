"""A release, built and tried by its one command."""

import re
import subprocess
import sys

import pytest

import rulec
from support.builders.recorded_data import DATA
from tools.gallery.drives import OF_OTHERS, OWN
from tools.programs import ROOT

pytestmark = pytest.mark.long


@pytest.mark.skipif(not DATA.is_dir(), reason="there are no shared recordings")
def test_a_release_is_whole_and_nothing_is_wrong_with_it(tmp_path):
    folder = tmp_path / "release"
    command = [sys.executable, "-m", "tools.release", "-o", folder, "--recordings", DATA]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
    version = rulec.__version__
    assert {path.name for path in folder.iterdir()} == {
        f"rulec-{version}-py3-none-any.whl",
        f"rulec-{version}.vsix",
        f"rulec-{version}-site.tar.gz",
        "rulec.cdx.json",
        "SHA256SUMS",
        "site",
    }
    assert {path.stem for path in (folder / "site/gallery").glob("*.html")} == {
        "index",
        *(drive.name for drive in (*OWN, *OF_OTHERS)),
    }
    front = (folder / "site/index.html").read_text(encoding="utf-8")
    assert set(re.findall(r'href="(gallery/[^"]*|playground/[^"]*)"', front)) == {
        "gallery/index.html",
        "playground/index.html",
    }
