"""Verdict for each clause of a frame, from the frame and the trace alone.

`frame_checks` is the entry: `check`, and `require_checkable` before anything is executed.
"""
