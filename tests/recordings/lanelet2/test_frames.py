"""The frame of a Lanelet2 map's places, by what is in it and beside it."""

import numpy as np
import pytest

from rulec.diagnostics import RulecError
from rulec.recordings.lanelet2.map_frame import utm_zone
from rulec.recordings.map_files import read_map
from support.builders.lanelet2_files import MapFile

HERE = (49.0, 8.4)


def road(lat, lon):
    """A lane 0.001° long to the east, 0.00004° wide, its right side beginning at a place."""
    file = MapFile(degrees=True)
    left = file.line((lat + 0.00004, lon), (lat + 0.00004, lon + 0.001))
    file.lanelet(left, file.line((lat, lon), (lat, lon + 0.001)))
    return file


def read(file, folder, projector=""):
    if projector:
        (folder / "map_projector_info.yaml").write_text(projector)
    found = read_map(file.write(folder), 0.1)
    (lanelet,) = found.lanelets.values()
    return lanelet.right, found.remarks


def with_origin(kind, lat, lon):
    return f"projector_type: {kind} # a word\nmap_origin:\n  latitude: {lat}\n  longitude: {lon}\n"


def test_metres_of_the_file_come_first(tmp_path):
    file = MapFile()
    file.lanelet(file.line((5, 3), (50, 3)), file.line((5, 0), (50, 0)))
    places, remarks = read(file, tmp_path)
    assert places.tolist() == [[5, 0], [50, 0]]
    assert not any("origin" in remark for remark in remarks)


def test_without_an_origin_places_are_those_of_utm(tmp_path):
    places, remarks = read(road(*HERE), tmp_path)
    # The meridian's arc to 49° N is 5 429 627.63 m, a degree of longitude there 73 171.79 m; 0.6°
    # west of the middle of zone 32 a parallel lies 6 390 320 * sin * cos * 0.6°² / 2 = 173.5 higher
    expected = [500_000 - 0.6 * 73_171.79 * 0.9996, 5_429_627.63 * 0.9996 + 173.5]
    assert places[0] == pytest.approx(expected, abs=0.5)
    assert np.hypot(*(places[1] - places[0])) == pytest.approx(73.17 * 0.9996, abs=0.02)
    assert any("zone 32 north" in remark for remark in remarks)


def test_the_southern_hemisphere_counts_from_ten_million(tmp_path):
    places, remarks = read(road(-0.5, 20.0), tmp_path)
    # A degree of latitude is 110 574 m at the equator
    assert places[0][1] == pytest.approx(10_000_000 - 0.5 * 110_574 * 0.9996, abs=30)
    assert any("zone 34 south" in remark for remark in remarks)


def test_at_latitude_and_longitude_0_the_origin_is_there(tmp_path):
    file = road(0.00001, 0.00001)
    places, remarks = read(file, tmp_path)
    # 3° off the middle of zone 31 its scale is 0.9996 * (1 + 3° squared / 2) = 1.00098
    east, north = 0.00001 * 111_319.49 * 1.00098, 0.00001 * 110_574.3 * 1.00098
    assert places[0] == pytest.approx([east, north], abs=2e-3)
    assert places[1][0] - places[0][0] == pytest.approx(111.32 * 1.00098, abs=0.02)
    assert not any("origin" in remark for remark in remarks)


def test_an_origin_beside_the_map(tmp_path):
    lat, lon = HERE
    plain, _ = read(road(*HERE), tmp_path)
    places, remarks = read(road(*HERE), tmp_path, with_origin("LocalCartesianUTM", lat, lon))
    assert places[0] == pytest.approx([0, 0], abs=1e-6)
    assert places[1] - places[0] == pytest.approx(plain[1] - plain[0], abs=1e-6)
    assert not any("origin" in remark for remark in remarks)


@pytest.mark.parametrize(
    ("kind", "scale"), [("LocalCartesian", 1.0), ("TransverseMercator", 0.9996)]
)
def test_other_projections_lead_east_from_their_origin(tmp_path, kind, scale):
    places, _ = read(road(*HERE), tmp_path, with_origin(kind, *HERE))
    assert places[0] == pytest.approx([0, 0], abs=1e-6)
    # One thousandth of the degree of longitude at 49° N, and straight to the east at first
    assert places[1] == pytest.approx([73.172 * scale, 0.0005], abs=2e-3)


def test_the_square_of_the_military_grid(tmp_path):
    plain, _ = read(road(*HERE), tmp_path)
    places, _ = read(road(*HERE), tmp_path, "projector_type: MGRS\nmgrs_grid: 32UMV\n")
    assert places == pytest.approx(plain - (400_000, 5_400_000), abs=1e-6)


@pytest.mark.parametrize(
    ("projector", "says"),
    [
        ("", "its `projector_type` is ``"),
        ("projector_type: Mercator\n", "its `projector_type` is `mercator`"),
        ("projector_type: LocalCartesianUTM\n", "it has no `map_origin`"),
        (with_origin("LocalCartesian", "north", 1), "its `latitude` is `north`"),
        (with_origin("LocalCartesian", "nan", 1), "its `latitude` is `nan`"),
        ("projector_type: Local\n", "a node has no `local_x` and `local_y`"),
    ],
)
def test_what_is_wrong_beside_the_map(tmp_path, projector, says):
    (tmp_path / "map_projector_info.yaml").write_text(projector)
    with pytest.raises(RulecError) as caught:
        read_map(road(*HERE).write(tmp_path), 0.1)
    (found,) = caught.value.diagnostics
    assert found.code == "R0610"
    assert says in found.message


@pytest.mark.parametrize(
    ("lat", "lon", "zone"),
    [
        *[(0, 0, 31), (0, -180, 1), (0, 180, 1), (0, 179.9, 60), (60, 5, 32), (55, 5, 31)],
        *[(78, 8, 31), (78, 10, 33), (78, 30, 35), (78, 40, 37), (71, 10, 32)],
    ],
)
def test_zones(lat, lon, zone):
    assert utm_zone(lat, lon) == zone
