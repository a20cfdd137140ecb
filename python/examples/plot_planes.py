#!/usr/bin/env python3
"""Draw the planes of a frame: plot_planes.py RECORDING PICTURE.png [FRAME] [CLOUD.ply]

CLOUD.ply: the same in space, colored, with Open3D.
"""

import sys

from matplotlib import pyplot

import planescope as ps
from planescope import plot


def main(path: str, picture: str, frame: str = "0", cloud: str = "") -> None:
    result = ps.segment(ps.Recording(path)[int(frame)])
    figure = pyplot.figure(figsize=(12, 5))
    if not result.frame.is_cloud:
        plot.overlay(result, figure.add_subplot(1, 2, 1))
    plot.scene(result, figure.add_subplot(1, 2, 2, projection="3d"))
    figure.savefig(picture, dpi=120)
    if cloud:
        import open3d

        merged = open3d.geometry.PointCloud()
        for part in result.to_open3d():
            merged += part
        open3d.io.write_point_cloud(cloud, merged)


if __name__ == "__main__":
    try:
        main(*sys.argv[1:])
    except (ps.Error, ImportError, IndexError, OSError, TypeError, ValueError) as error:
        sys.exit(f"{sys.argv[0]}: {error}")
