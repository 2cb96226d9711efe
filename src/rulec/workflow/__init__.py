"""The whole of rulec on three pages, by what it is given: rulebooks, traces, scenarios.

    source text -> syntax -> rulebook -> logic -> automata -> runtime -> verdicts
    scenario -> partition -> graph of traces ----------------^

The command line and ``import rulec`` are thin layers over these functions.
"""
