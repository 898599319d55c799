"""What commands share: their options, what they print and write, and lines typed at a prompt."""
