#!/usr/bin/env python3
"""Write the planes of a recording as a CSV table: recording_table.py RECORDING [TABLE.csv]"""

import csv
import sys
from concurrent.futures import ThreadPoolExecutor

import planescope as ps


def main(path: str, table: str = "/dev/stdout") -> None:
    recording = ps.Recording(path)
    segmenter = ps.Segmenter(max_range_m=2.5)
    with open(table, "w", newline="") as file, ThreadPoolExecutor() as pool:
        rows = csv.writer(file)
        rows.writerow(["frame", "id", "label", "tilt_deg", "height_m", "area_m2", "sigma_mm"])
        # Segmenting releases the interpreter, so threads are enough.
        for frame, result in enumerate(pool.map(segmenter.segment, recording)):
            for plane in result.planes:
                rows.writerow([
                    frame, plane.id, plane.label, f"{plane.tilt_deg:.2f}", f"{plane.height_m:.3f}",
                    f"{plane.area_m2:.3f}", f"{1000 * plane.certainty.sigma_m:.2f}",
                ])  # fmt: skip


if __name__ == "__main__":
    try:
        main(*sys.argv[1:])
    except (ps.Error, OSError, TypeError) as error:
        sys.exit(f"{sys.argv[0]}: {error}")
