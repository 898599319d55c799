"""Commands said in other words, those that the language was made with and those it was not."""
