#!/usr/bin/env python3
"""Follow planes with a live camera: live_loop.py [FRAMES]

The camera is simulated: it moves toward a step. Replace camera() with a driver's loop that yields depth
in meters (or uint16 counts) and T_world_camera, the pose of the camera in a world whose z points up.
"""

import sys
from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

import planescope as ps

WIDTH, HEIGHT, F = 320, 240, 240.0
K = np.array([[F, 0, (WIDTH - 1) / 2], [0, F, (HEIGHT - 1) / 2], [0, 0, 1]])


def camera(frames: int) -> Iterator[tuple[NDArray[np.float32], NDArray[np.float64]]]:
    """Simulate a camera 50 cm above the floor, tilted down by 30 degrees; a step of 15 cm at x = 1 m."""
    tilt = np.deg2rad(30)
    forward = np.array([np.cos(tilt), 0, -np.sin(tilt)])
    right = np.array([0, -1, 0])
    R = np.stack([right, np.cross(forward, right), forward], axis=1)  # world from camera
    u, v = np.meshgrid(np.arange(WIDTH), np.arange(HEIGHT))
    rays = np.stack([(u - K[0, 2]) / F, (v - K[1, 2]) / F, np.ones_like(u)], axis=-1) @ R.T
    random = np.random.default_rng(1)
    for i in range(frames):
        origin = np.array([0.02 * i, 0, 0.5])
        z = np.full(u.shape, np.inf)
        with np.errstate(divide="ignore", invalid="ignore"):
            for axis, at in ((2, 0.0), (0, 1.0), (2, 0.15)):  # floor, riser, tread
                t = (at - origin[axis]) / rays[..., axis]
                x, height = origin[0] + t * rays[..., 0], origin[2] + t * rays[..., 2]
                on = {0.0: x < 1, 1.0: (height > 0) & (height < 0.15), 0.15: x > 1}[at]
                z = np.where((t > 0) & on & (t < z), t, z)
        z[~np.isfinite(z)] = 0
        pose = np.eye(4)
        pose[:3, :3], pose[:3, 3] = R, origin
        yield (z * (1 + 0.001 * random.standard_normal(z.shape))).astype(np.float32), pose


def main(frames: str = "10") -> None:
    mapper = ps.Mapper(window_m=6)  # the map follows the robot
    for depth, pose in camera(int(frames)):
        added = mapper.add(ps.Frame(depth, K), pose)
        seen = ", ".join(
            f"T{track} {plane.label} {plane.centroid[2] + added.T_world_camera[2, 3]:+.2f} m"
            for track, plane in zip(added.tracks, added.result.planes)
            if track
        )
        print(f"frame {len(mapper) - 1}: {seen}")
    for held in mapper.map().planes:
        print(f"T{held.track}: {held.label}, height {held.centroid[2]:.2f} m, {held.area_m2:.2f} m2")


if __name__ == "__main__":
    try:
        main(*sys.argv[1:])
    except (ps.Error, TypeError, ValueError) as error:
        sys.exit(f"{sys.argv[0]}: {error}")
