"""Lanelet2 maps made by hand, in metres (`local_x`, `local_y`) or degrees."""

from dataclasses import dataclass, field

from support.builders.recorded_data import DATA

SAMPLES = DATA / "lanelet2"
"""Where maps of others are, if they are."""


def tags_of(tags):
    """The tags of an element; `__` in a name stands for a colon."""
    return "".join(f'<tag k="{k.replace("__", ":")}" v="{v}"/>' for k, v in tags.items())


@dataclass
class MapFile:
    """A map that is being written: nodes by place, lines through them, lanelets and rules."""

    degrees: bool = False
    nodes: dict = field(default_factory=dict)
    elements: list = field(default_factory=list)
    count: int = 0

    def node(self, x, y):
        """The id of the node at a place, the same for all who ask."""
        return self.nodes.setdefault((x, y), 1000 + len(self.nodes))

    def line(self, *places, **tags):
        """A line through places."""
        self.count += 1
        refs = "".join(f'<nd ref="{self.node(*place)}"/>' for place in places)
        self.elements.append(f'<way id="{self.count}">{refs}{tags_of(tags)}</way>')
        return self.count

    def relation(self, members, **tags):
        """A relation of members: role, kind and id each."""
        self.count += 1
        inside = "".join(f'<member type="{t}" ref="{r}" role="{role}"/>' for role, t, r in members)
        self.elements.append(f'<relation id="{self.count}">{inside}{tags_of(tags)}</relation>')
        return str(self.count)

    def lanelet(self, left, right, rules=(), **tags):
        """A lanelet between two lines, a road in a town unless its tags say something else."""
        bounds = [("left", "way", left), ("right", "way", right)]
        rules = [("regulatory_element", "relation", rule) for rule in rules]
        tags = {"type": "lanelet", "subtype": "road", "location": "urban", **tags}
        return self.relation([*bounds, *rules], **tags)

    def rule(self, subtype, members, **tags):
        """A regulatory element."""
        return self.relation(members, type="regulatory_element", subtype=subtype, **tags)

    def text(self):
        """The whole file."""
        nodes = "".join(map(self._node, self.nodes.items()))
        return f'<?xml version="1.0"?>\n<osm version="0.6">{nodes}{"".join(self.elements)}</osm>\n'

    def write(self, folder, name="map.osm"):
        """The file, in a folder."""
        path = folder / name
        path.write_text(self.text(), encoding="utf-8")
        return path

    def _node(self, item):
        (x, y), number = item
        if self.degrees:
            return f'<node id="{number}" lat="{x}" lon="{y}"/>'
        place = tags_of({"local_x": x, "local_y": y})
        return f'<node id="{number}" lat="" lon="">{place}</node>'


def two_way_street(**middle):
    """Two lanes of 3 m along x, 100 m long: `there` leads east, right of the line at y = 0.

    ``middle`` are the tags of that line. Traffic keeps right.
    """
    file = MapFile()
    middle = middle or {"type": "line_thin", "subtype": "dashed"}
    line = file.line((0, 0), (100, 0), **middle)
    south = file.line((0, -3), (100, -3), type="curbstone")
    north = file.line((0, 3), (100, 3), type="curbstone")
    there = file.lanelet(line, south)
    back = file.lanelet(line, north)
    return file, there, back


def every_element():
    """A small map with most that is read."""
    file, there, back = two_way_street()
    line = file.line((90, 0), (90, -3), type="stop_line")
    post = file.line((90, -5), (90, -6), type="traffic_sign", subtype="de205")
    lamp = file.line((92, -5), (92, -6), type="traffic_light")
    light = file.rule("traffic_light", [("refers", "way", lamp), ("ref_line", "way", line)])
    sign = file.rule("traffic_sign", [("refers", "way", post), ("ref_line", "way", line)])
    limit = file.rule("speed_limit", [], sign_type="30 km/h")
    on = file.lanelet(file.line((100, 0), (130, 0)), file.line((100, -3), (130, -3)), one_way="no")
    file.lanelet(
        file.line((130, 0), (150, 0)),
        file.line((130, -3), (150, -3)),
        rules=[light, sign, limit],
        turn_direction="left",
        region="de",
    )
    roles = [("yield", "relation", there), ("right_of_way", "relation", back)]
    file.rule("right_of_way", [*roles, ("refers", "way", post), ("ref_line", "way", line)])
    file.rule("all_way_stop", [("yield", "relation", on), ("ref_line", "way", line)])
    return file.text()
