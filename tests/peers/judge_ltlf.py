"""Judges finite words by LTLf formulas, with flloat alone. Runs in an environment of its own.

Standard input: JSON lines {"formula": text, "words": [[{proposition: bool, …}, …], …]}; standard
output: for each a JSON list of verdicts on the words as they are.
"""

import json
import sys

from flloat.parser.ltlf import LTLfParser

parse = LTLfParser()
for line in sys.stdin:
    job = json.loads(line)
    formula = parse(job["formula"])
    verdicts = [bool(formula.truth(word, 0)) for word in job["words"]]
    sys.stdout.write(json.dumps(verdicts) + "\n")
