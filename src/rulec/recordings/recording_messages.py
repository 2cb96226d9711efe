"""Messages about recordings."""

from __future__ import annotations

from rulec.diagnostics.code import Code

_COMMONROAD = """\
cat > road.xml <<'END'
<commonRoad commonRoadVersion="2018b" benchmarkID="ZAM_Road-1_1_T-1" timeStepSize="0.1"
    author="" affiliation="" source="" tags="" date="2020-01-01">
  <lanelet id="1">
    <leftBound><point><x>0</x><y>2</y></point><point><x>99</x><y>2</y></point></leftBound>
    <rightBound><point><x>0</x><y>-2</y></point><point><x>99</x><y>-2</y></point></rightBound>
  </lanelet>
  <planningProblem id="2">
    <initialState>
      <position><point><x>9</x><y>0</y></point></position>
      <velocity><exact>5</exact></velocity><orientation><exact>0</exact></orientation>
      <yawRate><exact>0</exact></yawRate><slipAngle><exact>0</exact></slipAngle>
      <time><exact>0</exact></time>
    </initialState>
    <goalState>
      <time><intervalStart>0</intervalStart><intervalEnd>40</intervalEnd></time>
    </goalState>
  </planningProblem>
</commonRoad>
END
"""
NOT_A_RECORDING = Code(
    "R0610",
    title="a file cannot be read as recorded traffic",
    why="Supported are the formats that `rulec list formats` lists: CommonRoad, SUMO, ASAM OSI, "
    "Argoverse 2, Waymo, ScenarioNet, tracks as tables, and maps. The format is detected "
    "from the file's name and first bytes; otherwise give it by `--input-format`. A file must be "
    "complete and valid; the message names the line, byte, row or record where it is not. XML "
    "must not have a `DOCTYPE`, and a pickle must not contain code, since these could do anything. "
    "CommonRoad's files are read in its versions 2018b and 2020a, but not in older ones.",
    bad=_COMMONROAD.replace("2018b", "2017a") + "rulec maneuvers road.xml -r esterle2019",
    good=_COMMONROAD + "rulec maneuvers road.xml -r esterle2019",
    kind="command",
)

NOT_IN_RECORDING = Code(
    "R0612",
    title="what is chosen is not in the recorded scene",
    why="A recorded scene has its own ids for planning problems, vehicles and lanelets, and its "
    "own times. The message lists what can be chosen by `--ego`, `--at-time` and `--reference`. "
    "By default ego is that of the first planning problem, so there must be one, and it must be "
    "on a lane.",
    bad=_COMMONROAD + "rulec maneuvers road.xml -r esterle2019 --ego 7",
    good=_COMMONROAD + "rulec maneuvers road.xml -r esterle2019 --ego 2",
    kind="command",
)

OTHER_CHOICE = Code(
    "R0613",
    title="an option for recorded scenes is used with another scenario",
    why="The options `--ego`, `--at-time`, `--reference`, `--prediction` and `--congested-below` "
    "choose from what was recorded. A built-in scenario, or one in TOML, itself defines ego, the "
    "road and how others move. `--map` is for tracks without roads, `--scenario` for files with "
    "several recordings.",
    bad="rulec maneuvers s1 -r esterle2019 --ego 2",
    good="rulec maneuvers s1 -r esterle2019",
    kind="command",
)

_FCD = """\
cat > fcd.xml <<'END'
<fcd-export>
  <timestep time="0.00">
    <vehicle id="f.0" x="20" y="0" angle="90" type="DEFAULT_VEHTYPE" speed="9" lane="east_0"/>
  </timestep>
</fcd-export>
END
"""
_NET = """\
cat > road.net.xml <<'END'
<net version="1.20">
  <edge id="east" from="a" to="b">
    <lane id="east_0" index="0" speed="13.89" length="200" shape="0,0 200,0"/>
  </edge>
</net>
END
"""
NET_MISSING = Code(
    "R0614",
    title="recorded traffic without roads has no map",
    why="SUMO's floating-car data and tracks as a table contain positions but no roads; these are "
    "in a map, such as SUMO's net. Without `--map`, it is the net named in a comment at the head "
    "of SUMO's data, or the only `*.net.xml` file in the same folder; for a table `NAME.csv` the "
    "lanes in `NAME.lanes.csv`, or in `lanes.csv`.",
    bad=_FCD + "rulec maneuvers fcd.xml -r esterle2019 --ego f.0",
    good=_NET + _FCD + "rulec maneuvers fcd.xml -r esterle2019 --ego f.0",
    kind="command",
)

OTHER_NET = Code(
    "R0615",
    title="recorded traffic and the map do not belong together",
    why="All lanes and edges that SUMO's data refer to must be in the net with which they were "
    "made, and all vehicles must be near its roads. Tracks as a table use the coordinates of "
    "their map, x and y in metres. Data with geographic coordinates cannot be used.",
    bad=_NET.replace("east", "west") + _FCD + "rulec maneuvers fcd.xml -r esterle2019 --ego f.0",
    good=_NET + _FCD + "rulec maneuvers fcd.xml -r esterle2019 --ego f.0",
    kind="command",
)

NOT_BUILT = Code(
    "R0617",
    title="a recording built by a program is invalid",
    why="Lanelets and participants need arrays of the right shapes, finite numbers and unique "
    "ids, and may refer only to existing ones. All mistakes are reported at once.",
    bad='import rulec\n\nrulec.build_lanelet("east", [(0, 0)], width=3.5)\n',
    good='import rulec\n\nrulec.build_lanelet("east", [(0, 0), (100, 0)], width=3.5)\n',
    kind="python",
)
