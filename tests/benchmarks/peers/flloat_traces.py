"""Rule R1 on finite traces, by flloat. A job is a list of traces, each a list of valuations."""

import json
import sys

from flloat.parser.ltlf import LTLfParser
from serving import serve

traces = json.loads(sys.stdin.readline())
formula = LTLfParser()("!(c) -> G(!(b & X(b U (r U f))))")
serve(lambda: [bool(formula.truth(trace, 0)) for trace in traces])
