"""All cases that have been thought out by hand."""

from support.cases.object_cases import CASES_OF_OBJECTS
from support.cases.rulebook_cases import CASES_OF_RULEBOOKS
from support.cases.time_cases import CASES_OF_TIME

CASES = {**CASES_OF_TIME, **CASES_OF_OBJECTS, **CASES_OF_RULEBOOKS}
