"""Pushes all over a face with the truth known (`map --experiment`)."""
