"""Another reader of Lanelet2 maps, the format's own library: lanelet2.

It has an environment of its own; hence only in the long run of the tests.
"""

import json
import os
import subprocess
from pathlib import Path

import pytest

from rulec.recordings.map_files import read_map
from support.builders.lanelet2_files import SAMPLES, MapFile
from support.oracles.lanelet2_library import assert_equal
from tools.programs import environment

pytestmark = pytest.mark.skipif(
    os.environ.get("RULEC_TEST_PROFILE") != "long", reason="builds an environment: --long"
)
PROGRAM = Path(__file__).with_name("read_with_lanelet2.py")
ORIGINS = {
    "mapping_example": (49.0, 8.42),
    "kashiwanoha": (35.9, 139.9),
    "crossroads_with_stoplines": (35.9, 139.9),
    "four_track_highway": (35.7, 139.7),
}


def read_by_library(path, origin):
    python = environment("lanelet2", "lanelet2==1.2.3") / "bin" / "python"
    lat, lon = origin
    command = [python, PROGRAM, f"{path},{lat},{lon}"]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    return json.loads(done.stdout)


@pytest.mark.parametrize("name", ORIGINS)
def test_maps_of_others(name):
    path = SAMPLES / f"{name}.osm"
    if not path.is_file():
        pytest.skip("no Lanelet2 maps are at hand: set RULEC_RECORDINGS")
    said = read_by_library(path, ORIGINS[name])
    assert not said["errors"]
    assert_equal(read_map(path, 0.1), said)


@pytest.mark.parametrize("place", [(0.0002, 0.0001), (49.003, 8.424), (-33.86, 151.2)])
def test_lines_drawn_any_way(tmp_path, place):
    lat, lon = place
    file = MapFile(degrees=True)
    rows = [[(lat + k * 4e-5 + (j % 2) * 1e-5, lon + j * 2e-4) for j in range(4)] for k in range(6)]
    lines = [
        file.line(*(row if k % 2 else row[::-1]), type="line_thin", subtype="dashed")
        for k, row in enumerate(rows)
    ]
    for k in range(5):
        # Those of odd numbers lead west
        file.lanelet(*(lines[k : k + 2] if k % 2 else lines[k : k + 2][::-1]), speed_limit="30")
    path = file.write(tmp_path)
    origin = (0, 0) if abs(lat) < 1 else place
    assert_equal(read_map(path, 0.1), read_by_library(path, origin))
