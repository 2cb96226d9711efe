"""OpenDRIVE files made by hand: roads of a few lanes, junctions, signals."""

from math import pi

from support.builders.recorded_data import DATA

XODR = (*sorted(DATA.glob("opendrive/*.xodr")), *sorted(DATA.glob("osi/*.xodr")))
"""Real maps, if they are at hand."""


def shared_map(name):
    """The real map of a name, None if it is not at hand."""
    return next((file for file in XODR if file.stem == name), None)


def document(*parts):
    """A whole file."""
    inside = "\n".join(parts)
    return f'<OpenDRIVE><header revMajor="1" revMinor="6"/>\n{inside}\n</OpenDRIVE>\n'


def cubic(tag, at, start, a, *more):
    """A polynomial element; ``at`` names the attribute of its start."""
    numbers = dict(zip("abcd", (a, *more, 0, 0, 0), strict=False))
    written = " ".join(f'{key}="{value}"' for key, value in numbers.items())
    return f'<{tag} {at}="{start}" {written}/>'


def lane(number, *, kind="driving", width=3.5, mark="", links="", more="", attributes=""):
    """A lane; ``width`` may be elements, too, and ``links`` are words such as ``successor=-2``."""
    widths = width if isinstance(width, str) else cubic("width", "sOffset", 0, width)
    linked = "".join(
        f'<{word} id="{other}"/>' for word, other in (x.split("=") for x in links.split())
    )
    marks = f'<roadMark sOffset="0" type="{mark}"/>' if mark else ""
    inside = f"<link>{linked}</link>" + (widths if number else "") + marks + more
    return f'<lane id="{number}" type="{kind}" {attributes}>{inside}</lane>'


def section(*lanes, start=0, attributes=""):
    """A lane section; lanes are sorted to the sides by their numbers."""
    by_side = {"left": [], "center": [], "right": []}
    for one in lanes:
        number = int(one.split('"')[1])
        by_side["left" if number > 0 else "right" if number else "center"].append(one)
    if not by_side["center"]:
        by_side["center"].append(lane(0, kind="none"))
    sides = "".join(f"<{side}>{''.join(own)}</{side}>" for side, own in by_side.items() if own)
    return f'<laneSection s="{start}" {attributes}>{sides}</laneSection>'


def geometry(shape="<line/>", *, s=0, x=0, y=0, hdg=0, length=100):
    """A piece of a reference line."""
    return f'<geometry s="{s}" x="{x}" y="{y}" hdg="{hdg}" length="{length}">{shape}</geometry>'


def road(
    number,
    *sections,
    plan=None,
    length=100,
    junction=-1,
    links="",
    offsets="",
    more="",
    attributes="",
):
    """A road; ``links`` are words such as ``successor=road:2:start``, ``successor=junction:9``."""
    linked = ""
    for word, element, other, *contact in (x.replace("=", ":").split(":") for x in links.split()):
        point = f' contactPoint="{contact[0]}"' if contact else ""
        linked += f'<{word} elementType="{element}" elementId="{other}"{point}/>'
    plan = plan or geometry(length=length)
    lanes = f"<lanes>{offsets}{''.join(sections)}</lanes>"
    inside = f"<link>{linked}</link><planView>{plan}</planView>{lanes}{more}"
    return (
        f'<road id="{number}" length="{length}" junction="{junction}" {attributes}>{inside}</road>'
    )


def signals(*each):
    """The signals of a road, each a dictionary of attributes.

    ``lanes`` is its validity, ``inside`` are further elements in it.
    """
    written = []
    for one in each:
        attributes = dict(one)
        lanes, tag = attributes.pop("lanes", None), attributes.pop("tag", "signal")
        inside = attributes.pop("inside", "")
        words = " ".join(f'{key}="{value}"' for key, value in attributes.items())
        valid = "" if lanes is None else f'<validity fromLane="{lanes[0]}" toLane="{lanes[1]}"/>'
        written.append(f"<{tag} {words}>{valid}{inside}</{tag}>")
    return f"<signals>{''.join(written)}</signals>"


def two_way(**changes):
    """Two lanes, one for each direction."""
    return section(lane(1, **changes), lane(-1, **changes))


def t_junction(*, west="", straight="", more=""):
    """Roads from the west (1), the south (2) and the east (3) meet; 1 and 2 lead on to 3.

    Road 1 leads east to x = 100, road 3 goes on at 120, road 2 comes from the south at x = 110.
    ``west`` and ``straight`` are further elements of road 1 and of 4, which leads on from it,
    ``more`` of the junction.
    """
    turn = '<arc curvature="-0.1"/>'
    return document(
        road(1, two_way(), links="successor=junction:9", more=west),
        road(
            2,
            two_way(),
            plan=geometry(x=110, y=-110, hdg=pi / 2),
            links="successor=junction:9",
        ),
        road(3, two_way(), plan=geometry(x=120), links="predecessor=junction:9"),
        road(
            4,
            section(lane(-1, links="predecessor=-1 successor=-1")),
            plan=geometry(x=100, length=20),
            length=20,
            junction=9,
            links="predecessor=road:1:end successor=road:3:start",
            more=straight,
        ),
        road(
            5,
            section(lane(-1, links="predecessor=-1 successor=-1")),
            plan=geometry(turn, x=110, y=-10, hdg=pi / 2, length=5 * pi),
            length=5 * pi,
            junction=9,
            links="predecessor=road:2:end successor=road:3:start",
        ),
        # The way back, whose link is written from its end
        road(
            6,
            section(lane(1, links="predecessor=1 successor=1")),
            plan=geometry(x=100, length=20),
            length=20,
            junction=9,
            links="predecessor=road:1:end successor=road:3:start",
        ),
        f"""<junction id="9" name="">
          <connection id="0" incomingRoad="1" connectingRoad="4" contactPoint="start">
            <laneLink from="-1" to="-1"/></connection>
          <connection id="1" incomingRoad="2" connectingRoad="5" contactPoint="start">
            <laneLink from="-1" to="-1"/></connection>
          <connection id="2" incomingRoad="3" connectingRoad="6" contactPoint="end">
            <laneLink from="1" to="1"/></connection>{more}</junction>""",
    )


def written(folder, text, name="made.xodr"):
    """A file with this text."""
    file = folder / name
    file.write_text(text, encoding="utf-8")
    return file


def every_element():
    """A small map with most that is read."""
    light = {"id": "l", "s": 98, "t": -4, "orientation": "+", "dynamic": "yes", "type": "1000001"}
    sign = {"id": "g", "s": 40, "t": -4, "orientation": "+", "type": "274", "value": "50"}
    crosswalk = '<object id="z" type="crosswalk" s="50" t="0" hdg="1.5" length="8" width="4"/>'
    plan = geometry('<spiral curvStart="0" curvEnd="0.02"/>', length=60) + geometry(
        '<paramPoly3 pRange="normalized" aU="0" bU="30" cU="5" dU="5" aV="0" bV="0" cV="3" '
        'dV="1"/>',
        s=60,
        x=59,
        y=12,
        hdg=0.6,
        length=40,
    )
    return document(
        road(
            1,
            section(
                lane(1, mark="broken", links="successor=1"),
                lane(-1, width=cubic("width", "sOffset", 0, 3, 0.01), links="successor=-1"),
            ),
            section(lane(1), lane(-1), lane(-2, kind="sidewalk"), start=50),
            plan=plan,
            links="successor=junction:9",
            offsets=cubic("laneOffset", "s", 0, 0.5),
            more='<type s="0" type="town"><speed max="50" unit="km/h"/></type>'
            f"<objects>{crosswalk}</objects>" + signals(light, sign),
        ),
        road(
            2,
            section(lane(-1, links="predecessor=-1 successor=-1")),
            plan=geometry('<arc curvature="0.1"/>', x=97, y=30, hdg=1, length=10),
            length=10,
            junction=9,
            links="predecessor=road:1:end successor=road:3:start",
            more=signals({"tag": "signalReference", "id": "l", "s": 0, "orientation": "+"}),
        ),
        road(
            3,
            two_way(),
            plan=geometry(cubic("poly3", "x", 0, 0, 0, 0.001), x=100, y=40, hdg=2, length=50),
            length=50,
            links="predecessor=junction:9",
        ),
        '<junction id="9" name=""><connection id="0" incomingRoad="1" connectingRoad="2" '
        'contactPoint="start"><laneLink from="-1" to="-1"/></connection>'
        '<priority high="2" low="2"/></junction>',
        '<controller id="c"><control signalId="l"/></controller>',
    )
