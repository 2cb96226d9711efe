"""Syntax tree nodes from parse nodes: one function per kind of piece."""
