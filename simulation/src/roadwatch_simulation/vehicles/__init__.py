"""Vehicles made from profiles, one file per thing a vehicle is made of."""
