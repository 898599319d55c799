"""Control of what the hand holds."""
