"""A simulated world for Roadwatch: streets, vehicles and people, rendered with exact truth."""
