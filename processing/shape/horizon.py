"""What a surface hides of the rays that it mirrors under other normals."""

HORIZON = 0.15
"""Cosine to the surface as it was, from which down a mirrored ray is more and more hidden by it."""
