"""Model files, plug-ins, mesh import."""
