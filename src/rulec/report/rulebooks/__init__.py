"""Rules and rulebooks, their lineage, audits and differences, in several formats."""
