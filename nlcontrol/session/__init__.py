"""Controller, conversation, a frame's run, exploration commands."""
