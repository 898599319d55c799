"""The store of the service: runs and their events in SQLite, traces and replays as files."""
