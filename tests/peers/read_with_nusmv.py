"""Reads SMV files with NuSMV; a program for Python 3.6, for which NuSMV comes as a wheel.

On standard input a line of JSON for each file: ``file``, and whether its specifications are to be
``checked``. On standard output a line each: how many ``specifications`` it has, and which of them
are ``kept``.
"""

import json
import sys

from pynusmv.glob import compute_model, flatten_hierarchy, load_from_file, prop_database
from pynusmv.init import deinit_nusmv, init_nusmv
from pynusmv.mc import check_ltl_spec

for line in sys.stdin:
    job = json.loads(line)
    init_nusmv()
    load_from_file(job["file"])
    flatten_hierarchy()
    specifications = list(prop_database())
    answer = {"specifications": len(specifications)}
    if job["checked"]:
        compute_model()
        answer["kept"] = [check_ltl_spec(one.expr) for one in specifications]
    del specifications
    print(json.dumps(answer), flush=True)
    deinit_nusmv()
