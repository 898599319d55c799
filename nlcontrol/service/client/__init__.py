"""The client: a planning session at a server, used as one in this process is."""
