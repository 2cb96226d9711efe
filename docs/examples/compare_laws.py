"""List the rules in which two laws differ, and traces that one forbids and the other allows."""

import rulec

diff = rulec.diff("de", "gb", patterns=["keep_*", "pass_*"])
for row in diff.rows():
    print(row["rule"], "-", row["relation"])
for trace in diff.witnesses:
    print(trace.id, f"({len(trace.states)} states)")
