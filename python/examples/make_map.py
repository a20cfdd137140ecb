#!/usr/bin/env python3
"""Make a map of a recording: make_map.py RECORDING [POSES]

POSES: a file (TUM, KITTI, Open3D), or a .npy array (n, 4, 4) of T_world_camera, one per frame.
"""

import sys

import numpy as np

import planescope as ps


def main(path: str, poses: str = "") -> None:
    recording = ps.Recording(path)
    given = np.load(poses) if poses.endswith(".npy") else poses or None
    made = ps.make_map(recording, poses=given, threads=4)
    for warning in made.warnings:
        print(warning, file=sys.stderr)
    for plane in made.planes:
        print(
            f"track {plane.track}: {plane.label}, {plane.area_m2:.2f} m2, seen in"
            f" {plane.frames_seen} frames, offset within {1000 * plane.sigma_offset_m:.1f} mm"
        )


if __name__ == "__main__":
    try:
        main(*sys.argv[1:])
    except (ps.Error, OSError, TypeError) as error:
        sys.exit(f"{sys.argv[0]}: {error}")
