"""Linear temporal logic over a vocabulary's atoms: formulas, their meaning on a word, printing."""
