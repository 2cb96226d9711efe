"""Rules as text in linear temporal logic, for other tools."""
