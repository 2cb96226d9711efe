"""Linear temporal logic over a vocabulary's atoms: formulas, semantics, printing."""
