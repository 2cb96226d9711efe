"""Waymo's motion data, read as recordings, without TensorFlow."""
