"""A planning session for language models: tools of the Model Context Protocol over stdio."""
