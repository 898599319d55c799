"""The planning service: look, plan, approve, do, verify; in this process, or over a wire."""
