"""All cases that have been thought out by hand."""

from cases_of_objects import CASES_OF_OBJECTS
from cases_of_rulebooks import CASES_OF_RULEBOOKS
from cases_of_time import CASES_OF_TIME

CASES = {**CASES_OF_TIME, **CASES_OF_OBJECTS, **CASES_OF_RULEBOOKS}
