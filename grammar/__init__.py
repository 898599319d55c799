"""From an English sentence to frames: a lark grammar, a lexicon, and the frames themselves."""
