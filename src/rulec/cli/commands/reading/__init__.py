"""Commands to read and compare laws."""
