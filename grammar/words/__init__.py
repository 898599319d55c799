"""Text to tokens: normalisation, numbers, lexicon (YAML, plug-ins), lexer."""
