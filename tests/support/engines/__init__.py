"""Everything that judges traces, behind one interface."""
