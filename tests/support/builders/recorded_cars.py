"""A CommonRoad file of three cars on one lane, 4 m wide, along the x axis, for 2.9 s."""

from support.builders.recordings import ROAD_XML

MOVING = """
  <obstacle id="{number}">
    <role>dynamic</role>
    <type>car</type>
    <shape><rectangle><length>4</length><width>1.5</width></rectangle></shape>
    <initialState>
      <position><point><x>{x}</x><y>{y}</y></point></position>
      <orientation><exact>0</exact></orientation><time><exact>0</exact></time>
      <velocity><exact>{speed}</exact></velocity>
    </initialState>
    <trajectory>{states}</trajectory>
  </obstacle>
"""
STATE = """<state><position><point><x>{x}</x><y>{y}</y></point></position>
  <orientation><exact>0</exact></orientation><time><exact>{step}</exact></time>
  <velocity><exact>{speed}</exact></velocity></state>"""


def car(number, x, y, speed, steps=30):
    states = (
        STATE.format(x=x + speed * 0.1 * step, y=y, step=step, speed=speed)
        for step in range(1, steps)
    )
    return MOVING.format(number=number, x=x, y=y, speed=speed, states="".join(states))


def three_cars(folder):
    """3 at 12 m/s from x = 10, 4 behind it at 14 m/s from x = 2, 5 at 4 m/s from x = 60."""
    start, end = ROAD_XML.index("  <obstacle"), ROAD_XML.index("  <planning")
    cars = car(3, 10, 0, 12) + car(4, 2, 0, 14) + car(5, 60, 0, 4)
    file = folder / "DEU_Road-1_1_T-1.xml"
    file.write_text(ROAD_XML[:start] + cars + ROAD_XML[end:])
    return str(file)
