"""Every reason in words, with its numbers."""
