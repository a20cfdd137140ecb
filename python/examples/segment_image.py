#!/usr/bin/env python3
"""Find the planes of one depth image: segment_image.py DEPTH.png FX FY CX CY [METERS_PER_COUNT]"""

import sys

import numpy as np
from PIL import Image

import planescope as ps


def main(file: str, fx: str, fy: str, cx: str, cy: str, depth_unit: str = "0.001") -> None:
    depth = np.asarray(Image.open(file)).astype(np.uint16)
    K = (float(fx), float(fy), float(cx), float(cy))
    result = ps.segment(depth, K, depth_unit=float(depth_unit), foot_radius_m=0.08)
    print(result.table(), end="")
    for plane in result.planes:
        if plane.foothold and plane.foothold.steppable:
            print(f"plane {plane.id}: {plane.foothold.area_m2:.2f} m2 for the center of a foot")
    for flight in result.flights:
        print(f"stairs: {len(flight.steps)} steps of {100 * flight.rise_m:.0f} cm")


if __name__ == "__main__":
    try:
        main(*sys.argv[1:])
    except (ps.Error, OSError, TypeError) as error:
        sys.exit(f"{sys.argv[0]}: {error}")
