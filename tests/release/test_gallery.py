"""The gallery: each drive shows the violation that its sentence tells of."""

import re
from dataclasses import replace
from hashlib import sha256

import pytest

import rulec
from support.builders.recorded_data import DATA
from tools.browser.served import served
from tools.gallery import recordings
from tools.gallery.drives import OF_OTHERS, OWN
from tools.gallery.page import build
from tools.gallery.recordings import put_recording
from tools.programs import ROOT, MissingPartError

FOLLOWING = [drive for drive in OWN if drive.name == "following"]
needs_recordings = pytest.mark.skipif(not DATA.is_dir(), reason="there are no shared recordings")


def shows_what_it_tells(folder, drive):
    """Page and picture are of this drive's violation, the page in the list."""
    index = (folder / "index.html").read_text(encoding="utf-8")
    assert f'<a href="{drive.name}.html">' in index
    assert drive.sees in index
    page = (folder / f"{drive.name}.html").read_text(encoding="utf-8")
    title = re.search(r"<title>(.*?)</title>", page)[1]
    assert re.search(rf", {drive.ego}: [1-9]\d* violations?\b.* by {drive.book}$", title)
    picture = (folder / f"{drive.name}.svg").read_text(encoding="utf-8")
    x, y, width, height = map(
        float,
        re.search(
            rf"{drive.name}\.svg#svgView\(viewBox\(([\d.]+),([\d.]+),(\d+),(\d+)\)\)", index
        ).groups(),
    )
    drawn = re.search(r'<svg [^>]* width="(\d+)" height="(\d+)"', picture)
    assert x >= 0
    assert y >= 0
    assert x + width <= int(drawn[1])
    assert y + height <= int(drawn[2])
    if "*" not in drive.rule:
        assert f"hard rule {drive.rule} " in picture


def test_a_gallery_of_one_drive(tmp_path):
    build(tmp_path / "gallery", FOLLOWING)
    shows_what_it_tells(tmp_path / "gallery", *FOLLOWING)
    index = (tmp_path / "gallery/index.html").read_text(encoding="utf-8")
    (command,) = re.findall(r"<code>rulec (draw drive .*?)</code>", index)
    assert command.startswith("draw drive docs/samples/following.xml -r de --ego 1 ")
    assert "{{" not in index


@pytest.mark.long
def test_drives_of_the_checkout_show_what_is_told(tmp_path):
    build(tmp_path / "gallery", OWN)
    for drive in OWN:
        shows_what_it_tells(tmp_path / "gallery", drive)


@pytest.mark.long
@needs_recordings
def test_drives_of_others_show_what_is_told(tmp_path):
    build(tmp_path / "gallery", OF_OTHERS, DATA)
    for drive in OF_OTHERS:
        shows_what_it_tells(tmp_path / "gallery", drive)


def test_every_drive_has_its_files_and_a_law_that_ships():
    drives = (*OWN, *OF_OTHERS)
    assert len({drive.name for drive in drives}) == len(drives)
    assert {drive.book for drive in drives} <= {book.name for book in rulec.list()}
    for drive in OWN:
        assert (ROOT / drive.data.path).is_file()
        assert (ROOT / drive.data.net).exists()


@pytest.fixture
def elsewhere():
    """A recording of others, and its bytes."""
    data = b"<commonRoad/>"
    return replace(OF_OTHERS[0].data, sha256=sha256(data).hexdigest()), data


def test_a_recording_is_found_in_a_folder(elsewhere, tmp_path):
    recorded, data = elsewhere
    (tmp_path / "deep/work").mkdir(parents=True)
    with pytest.raises(MissingPartError, match=f"has no {recorded.name}"):
        put_recording(recorded, tmp_path / "deep/work", tmp_path)
    (tmp_path / "deep" / recorded.name).write_bytes(data)
    assert put_recording(recorded, tmp_path / "deep/work", tmp_path).read_bytes() == data


def test_another_recording_of_its_name_is_refused(elsewhere, tmp_path):
    recorded, data = elsewhere
    (tmp_path / recorded.name).write_bytes(data + b"\n")
    with pytest.raises(MissingPartError, match="is another file"):
        put_recording(recorded, tmp_path, tmp_path)


def test_a_recording_is_fetched_from_its_repository(elsewhere, tmp_path, monkeypatch):
    recorded, data = elsewhere
    there = tmp_path / recorded.repository / recorded.commit / recorded.path
    there.parent.mkdir(parents=True)
    with served(tmp_path) as address:
        monkeypatch.setattr(recordings, "PUBLIC", address.rstrip("/"))
        with pytest.raises(MissingPartError, match="--recordings names a folder"):
            put_recording(recorded, tmp_path, None)
        there.write_bytes(data)
        assert put_recording(recorded, tmp_path, None).read_bytes() == data
