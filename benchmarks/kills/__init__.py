"""The service, its page and its commands outlive kills, signals and faults."""
