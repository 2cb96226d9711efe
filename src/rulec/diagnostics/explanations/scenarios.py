"""R06: scenarios, and the graphs made from them."""

from rulec.diagnostics.explanations.explanation import Explanation

_ROAD = "[road]\ns = [0.0, 100.0]\nlanes = [-1.75, 1.75]\n\n"
_GOOD = f"{_ROAD}[ego]\ns = 10.0\nd = 0.0\n"
_CAR = '[[obstacle]]\nid = "car"\ntype = "vehicle"\nlength = 5.0\nwidth = 1.8\n'
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

_NET = """\
cat > road.net.xml <<'END'
<net version="1.20">
  <edge id="east" from="a" to="b">
    <lane id="east_0" index="0" speed="13.89" length="200" shape="0,0 200,0"/>
  </edge>
</net>
END
"""
_FCD = """\
cat > fcd.xml <<'END'
<fcd-export>
  <timestep time="0.00">
    <vehicle id="f.0" x="20" y="0" angle="90" type="DEFAULT_VEHTYPE" speed="9" lane="east_0"/>
  </timestep>
</fcd-export>
END
"""

_WEIGHTS = """\
{{ echo "rulebook many use road"; nexts=""; w=1; for rule in $(seq 16); do
    echo "soft rule r$rule (v: vehicle) weight {weight} {{ require $nexts same_lane(v) }}"
    nexts="$nexts next"; w=$((2 * w)); done
  echo "soft rule same (v: vehicle) weight $w {{ require $nexts same_lane(v) }}"
  echo "soft rule other (v: vehicle) weight $w {{ require $nexts not same_lane(v) }}"
}} > many.rules
rulec maneuvers s2 --step 0.25 --rank 1 -r ./many.rules
"""

SCENARIOS = {
    "R0601": Explanation(
        "a scenario's name is unknown",
        "A scenario is one of those built in (`rulec list scenarios`), or a file, given by its "
        "path.",
        "rulec maneuvers s9 -r esterle2019",
        "rulec maneuvers s1 -r esterle2019",
        "command",
    ),
    "R0602": Explanation(
        "a scenario file is too large or not TOML",
        "Scenario files are TOML of at most 4 MB. The message tells what TOML's reader met at the "
        "underlined place.",
        _GOOD.replace("[0.0, 100.0]", "0.0 to 100.0"),
        _GOOD,
        "scenario",
    ),
    "R0603": Explanation(
        "a field of a scenario is missing or unknown",
        "Road and ego have to be there with their fields. An unknown field is an error, because a "
        "misspelt one would otherwise be ignored.",
        _GOOD.replace("d = 0.0", "D = 0.0"),
        _GOOD,
        "scenario",
    ),
    "R0604": Explanation(
        "a field's value in a scenario does not fit",
        "Numbers are finite and in metres, seconds, m/s, m/s² and degrees, without a unit behind "
        "them; the message says what is expected.",
        _GOOD.replace("s = 10.0", 's = "10 m"'),
        _GOOD,
        "scenario",
    ),
    "R0605": Explanation(
        "parts of a scenario contradict each other",
        "Each part can be read, and together they cannot be: a place beside the road, an id that "
        "is given twice, times that run backwards.",
        _GOOD.replace("s = 10.0", "s = 110.0"),
        _GOOD,
        "scenario",
    ),
    "R0606": Explanation(
        "horizon and step do not fit together",
        "The horizon is cut into steps, so it has to be a whole multiple of the step, and both "
        "are times above 0.",
        f"horizon_s = 4.0\nstep_s = 0.3\n\n{_GOOD}",
        f"horizon_s = 4.2\nstep_s = 0.3\n\n{_GOOD}",
        "scenario",
    ),
    "R0607": Explanation(
        "ego has no free cell to start from",
        "An obstacle will be in ego's place within the first step, so no maneuver can begin there: "
        "ego would be hit. Move one of them, or take a shorter step.",
        f"{_GOOD}\n{_CAR}s = 0.0\nd = 0.0\nspeed = 20.0\n",
        f"{_GOOD}\n{_CAR}s = 20.0\nd = 0.0\nspeed = 20.0\n",
        "scenario",
    ),
    "R0608": Explanation(
        "a partition, an adjacency or an extent is unknown",
        "The partitions are `paper` and `fine`, the adjacencies `touch`, `edge` and `forward`, the "
        "extents `lane` and `body`.",
        'import rulec\n\nrulec.navigation_graph("s1", partition="papre")\n',
        'import rulec\n\nrulec.navigation_graph("s1", partition="paper")\n',
        "python",
    ),
    "R0609": Explanation(
        "a path does not follow the navigation graph",
        "A path has one cell for each layer, from the first on, and from each to the next there "
        "is an edge. Paths come from `Maneuvers.cheapest`, or from walking through `successors`.",
        "import rulec\nfrom rulec.partition import envelope\n\n"
        'graph = rulec.navigation_graph("s1")\nenvelope(graph, [graph.start, 999])\n',
        "import rulec\nfrom rulec.partition import envelope\n\n"
        'graph = rulec.navigation_graph("s1")\n'
        "envelope(graph, [graph.start, graph.successors[0][graph.start][0]])\n",
        "python",
    ),
    "R0610": Explanation(
        "a file cannot be read as recorded traffic",
        "Recorded traffic is XML: a CommonRoad scenario, version 2018b or 2020a, or SUMO's "
        "floating-car data with their net; the root element tells which. A file has to be "
        "well-formed and complete, and to do without a `DOCTYPE`: what that defines may fill the "
        "memory or fetch other files.",
        _COMMONROAD.replace("2018b", "2017a") + "rulec maneuvers road.xml -r esterle2019",
        _COMMONROAD + "rulec maneuvers road.xml -r esterle2019",
        "command",
    ),
    "R0611": Explanation(
        "the package for CommonRoad scenarios is not installed",
        "They are read by `commonroad-io`, which is installed on request, because it takes some "
        "370 MB with what it needs: `pip install 'rulec[commonroad]'`. In a checkout that is "
        "`.venv/bin/python -m pip install -e '.[commonroad]'`.",
        "",
        "",
        "circumstance",
    ),
    "R0612": Explanation(
        "what is chosen is not in the recorded scene",
        "A recorded scene has its own ids for planning problems, vehicles and lanelets, and "
        "its own times. The message names those that can be chosen with `--ego`, `--at-time` and "
        "`--reference`. Without any choice, ego is the first planning problem's, so there has to "
        "be one, and it has to be on a lane.",
        _COMMONROAD + "rulec maneuvers road.xml -r esterle2019 --ego 7",
        _COMMONROAD + "rulec maneuvers road.xml -r esterle2019 --ego 2",
        "command",
    ),
    "R0613": Explanation(
        "a choice for recorded scenes was made for another scenario",
        "What `--ego`, `--at-time`, `--reference`, `--prediction` and `--congested-below` choose "
        "from is what was recorded. A built-in scenario, or one in TOML, says itself where ego and "
        "the road are and how others move. `--net` is for SUMO's floating-car data only, because "
        "all other scenes have their own roads.",
        "rulec maneuvers s1 -r esterle2019 --ego 2",
        "rulec maneuvers s1 -r esterle2019",
        "command",
    ),
    "R0614": Explanation(
        "floating-car data of SUMO's have no net",
        "They say where everybody was, but not where the roads are; that is in SUMO's net. Without "
        "`--net` it is the one that a comment at the head of the data names, or the only file "
        "`*.net.xml` in the same folder.",
        _FCD + "rulec maneuvers fcd.xml -r esterle2019 --ego f.0",
        _NET + _FCD + "rulec maneuvers fcd.xml -r esterle2019 --ego f.0",
        "command",
    ),
    "R0615": Explanation(
        "floating-car data of SUMO's and the net do not belong together",
        "All lanes and edges that the data name are in the net that they were made with, and "
        "everybody is near its roads. Data with geographic coordinates cannot be used.",
        _NET.replace("east", "west") + _FCD + "rulec maneuvers fcd.xml -r esterle2019 --ego f.0",
        _NET + _FCD + "rulec maneuvers fcd.xml -r esterle2019 --ego f.0",
        "command",
    ),
    "R0616": Explanation(
        "rules keep too many maneuvers apart",
        "Maneuvers are counted and ranked together where they are at one place, the automata of "
        "all rules are in one state, and what is violated costs the same. Rules of the law come to "
        "few such states and costs, but there can be as many states as the product of all automata "
        "has, and as many costs as rules have subsets. Judge by fewer rules at a time, choose a "
        "larger step, or let rules that matter alike have one weight.",
        _WEIGHTS.format(weight="$w"),
        _WEIGHTS.format(weight="1"),
        "command",
    ),
}
