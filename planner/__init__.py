"""From a frame and a predicted outcome to a push, or to a refusal with its numbers."""
