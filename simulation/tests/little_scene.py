"""A few things to look at, small enough to draw in a blink."""

import numpy as np

from roadwatch_simulation.model import Camera, Instance, Light, Material, Mesh, Model, Surface

WIDTH, HEIGHT = 320, 180
NOON = Light(sun_direction=(0.4, -0.5, 0.75))


def camera(cx=151.25, cy=97.5, focal=260.0, height_m=1.5, x_m=0.0):
    """A camera that looks along x; its principal point lies off the middle of the image."""
    world_from_camera = np.eye(4)
    world_from_camera[:3, :3] = [[0, 0, 1], [-1, 0, 0], [0, -1, 0]]
    world_from_camera[:3, 3] = [x_m, 0.0, height_m]
    return Camera(WIDTH, HEIGHT, focal, focal * 1.01, cx, cy, world_from_camera)


def pose(x_m, y_m, yaw_rad=0.0):
    matrix = np.eye(4)
    matrix[:2, :2] = [[np.cos(yaw_rad), -np.sin(yaw_rad)], [np.sin(yaw_rad), np.cos(yaw_rad)]]
    matrix[:2, 3] = [x_m, y_m]
    return matrix


def plane(corners, surface=Surface.PLAIN, colour=(0.3, 0.3, 0.3)):
    """A model of one rectangle, its corners in order."""
    corners = np.array(corners, dtype=np.float32)
    positions = np.stack([corners[[0, 1, 2]], corners[[0, 2, 3]]])
    normal = np.cross(corners[1] - corners[0], corners[2] - corners[0])
    normals = np.broadcast_to(normal / np.linalg.norm(normal), positions.shape).astype(np.float32)
    zeros = np.zeros(2, dtype=np.int32)
    mesh = Mesh(positions, normals, zeros, zeros)
    return Model("plane", mesh, (Material("plane", colour, surface=surface),))


def ground(surface=Surface.ASPHALT):
    return Instance(plane([(-50, -50, 0), (150, -50, 0), (150, 50, 0), (-50, 50, 0)], surface), np.eye(4))


def wall(x_m, y_low_m, y_high_m):
    corners = [(x_m, y_low_m, 0), (x_m, y_high_m, 0), (x_m, y_high_m, 3), (x_m, y_low_m, 3)]
    return Instance(plane(corners), np.eye(4))


def mask_box(mask):
    """Edges of the true pixels: left, top, right, bottom."""
    columns, rows = np.flatnonzero(mask.any(axis=0)), np.flatnonzero(mask.any(axis=1))
    return (columns[0], rows[0], columns[-1] + 1, rows[-1] + 1)
