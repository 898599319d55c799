"""Commands with words that forbid, postpone or restrict them."""
