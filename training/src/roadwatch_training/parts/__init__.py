"""The key-component model: a small head over a detector's frozen features, run on one crop per vehicle.

It finds a vehicle's tyres, mirrors, plates and lamps, and says from which side the vehicle is seen.
"""
