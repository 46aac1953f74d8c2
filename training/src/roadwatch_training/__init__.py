"""Roadwatch's own networks: trained on simulated images only, exported for the daemon, and scored."""
