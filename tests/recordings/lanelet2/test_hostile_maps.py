"""Whatever is in an OSM file: it is read as a map, or refused in a sentence, at its line."""

import gzip

import pytest

from rulec.diagnostics import RulecError
from rulec.recordings.lanelet2 import lanelet2_map, map_lanelets, osm_file
from rulec.recordings.map_files import read_map
from support.builders.counted_steps import grows_in_proportion
from support.builders.lanelet2_files import MapFile, two_way_street


def refused(path):
    with pytest.raises(RulecError) as caught:
        read_map(path, 0.1)
    (found,) = caught.value.diagnostics
    assert found.code == "R0610"
    assert "\n" not in found.message
    return found


def written(folder, text):
    path = folder / "map.osm"
    path.write_text(text)
    return path


def street():
    file, _, _ = two_way_street()
    return file.text()


def test_plain_openstreetmap_is_no_map_of_lanes(tmp_path):
    file = MapFile(degrees=True)
    file.line((49, 8), (49.001, 8), highway="residential")
    found = refused(file.write(tmp_path))
    assert "it has no lanelets; it may be plain OpenStreetMap" in found.message
    assert "left and a right bound" in found.help


def test_packed_maps_are_read(tmp_path):
    path = tmp_path / "map.osm.gz"
    path.write_bytes(gzip.compress(street().encode()))
    assert len(read_map(path, 0.1).lanelets) == 2


@pytest.mark.parametrize(
    ("before", "after", "says"),
    [
        ("</osm>", "", "it has been cut short"),
        ('<osm version="0.6">', "<!DOCTYPE a><osm>", "it has a `DOCTYPE`"),
        ('id="1000"', 'id="1001"', "there are two nodes `1001`"),
        ('way id="1"', 'way id="2"', "there are two elements `way` with the id `2`"),
        ('relation id="4"', 'relation id="5"', "two elements `relation` with the id `5`"),
        ('id="1000"', 'id="first"', "`id` of a `node` is `first`"),
        ('id="1000"', "", "the element `node` has no `id`"),
        ('k="local_x" v="0"', 'k="local_x" v="nan"', "`local_x` of a `tag` is `nan`"),
        ('k="local_x" v="0"', 'k="local_x" v="1e9"', "`local_x` of a `tag` is `1e9`"),
        ('k="local_x" v="100"', 'k="local_x" v="1e6"', "a lanelet's bound is longer than 20 km"),
        ('k="local_x" v="0"', 'k="name" v="0"', "a node has no `lat` and `lon`"),
        ('lat="" lon=""', 'lat="91" lon="1"', "`lat` of a node is 91"),
        (
            'type="way" ref="1"',
            'type="way" ref="77"',
            "none of its lanelets has a left and a right",
        ),
        ('role="left"', 'role="l"', "none of its lanelets has a left and a right"),
    ],
)
def test_what_is_wrong(tmp_path, before, after, says):
    text = street()
    assert before in text
    count = -1 if before in ('type="way" ref="1"', 'role="left"') else 1
    assert says in refused(written(tmp_path, text.replace(before, after, count))).message


def test_the_line_of_what_is_wrong(tmp_path):
    text = street().replace("<node", "\n<node")
    # The third node is on the fifth line: the declaration, the root, and the nodes
    found = refused(written(tmp_path, text.replace('id="1002"', 'id="1000"')))
    assert found.place.line == 5


def test_degrees_far_from_the_others(tmp_path):
    file = MapFile(degrees=True)
    file.lanelet(file.line((49, 8), (49, 8.001)), file.line((48.999, 8), (48.999, 28)))
    assert "is more than 10° from the middle" in refused(file.write(tmp_path)).message


def test_a_broken_lanelet_does_not_hide_the_others(tmp_path):
    file, there, back = two_way_street()
    point = file.line((0, 0))
    broken = [file.lanelet(1, 99), file.lanelet(1, point), file.lanelet(1, back)]
    found = read_map(file.write(tmp_path), 0.1)
    assert found.lanelets.keys() == {there, back}
    (said,) = (remark for remark in found.remarks if "left out" in remark)
    assert all(f"`{name}`" in said for name in broken)


def test_what_an_editor_has_deleted_is_gone(tmp_path):
    file, there, back = two_way_street()
    text = file.text().replace(f'relation id="{back}"', f'relation id="{back}" action="delete"')
    assert read_map(written(tmp_path, text), 0.1).lanelets.keys() == {there}


@pytest.mark.parametrize(
    ("module", "limit", "says"),
    [
        (osm_file, "MOST_NODES", "there are more than 3 nodes"),
        (osm_file, "MOST_WAYS", "more than 3 elements"),
        (osm_file, "MOST_REFERENCES", "there are more than 3 references"),
        (map_lanelets, "MOST_POINTS", "have more than 3 points"),
    ],
)
def test_counts_are_bounded(tmp_path, monkeypatch, module, limit, says):
    monkeypatch.setattr(module, limit, 3)
    file, _, _ = two_way_street()
    file.line((1, 1), (2, 2))
    assert says in refused(file.write(tmp_path)).message


def test_lanelets_at_one_place_are_bounded(tmp_path, monkeypatch):
    monkeypatch.setattr(lanelet2_map, "MOST_AT_ONE_PLACE", 5)
    file = MapFile()
    left, right = file.line((0, 2), (9, 2)), file.line((0, 0), (9, 0))
    for _ in range(6):
        file.lanelet(left, right)
    assert (
        "more than 5 lanelets begin or end at the same nodes"
        in refused(file.write(tmp_path)).message
    )


def test_rules_of_many_members_are_refused(tmp_path):
    file, there, _ = two_way_street()
    file.rule("right_of_way", [("yield", "relation", there)] * 1001)
    assert "more than 1,000 members" in refused(file.write(tmp_path)).message


def long_road(pieces):
    file = MapFile()
    for k in range(pieces):
        lines = [[(k * 10 + j, y) for j in range(11)] for y in (0, -3)]
        file.lanelet(*(file.line(*line) for line in lines))
    return file


def test_reading_takes_steps_in_proportion(tmp_path):
    def read(pieces):
        path = long_road(pieces).write(tmp_path, f"{pieces}.osm")
        assert len(read_map(path, 0.1).lanelets) == pieces

    assert grows_in_proportion(read, 40)
