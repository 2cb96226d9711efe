"""Builds syntax tree nodes from parse nodes, with one function per kind of piece."""
