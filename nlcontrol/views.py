"""Pictures and replays of what was done."""

from __future__ import annotations

from sim.views.trace_picture import save_picture as save_picture
from sim.views.viewer_recording import save_replay as save_replay
