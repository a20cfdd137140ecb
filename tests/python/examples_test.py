"""examples_test.py EXAMPLES SAMPLE: all scripts in python/examples work, and report invalid input in one line."""

import subprocess
import sys
import tempfile
from pathlib import Path

examples, sample = Path(sys.argv[1]), sys.argv[2]


def run(name, *arguments, fails=False):
    ran = subprocess.run([sys.executable, examples / name, *map(str, arguments)], capture_output=True, text=True)
    assert bool(ran.returncode) == fails, f"{name}: {ran.stdout}{ran.stderr}"
    if fails:
        assert len(ran.stderr.splitlines()) == 1, f"{name}: {ran.stderr}"
    return ran.stderr if fails else ran.stdout


with tempfile.TemporaryDirectory() as folder:
    out = Path(folder)
    import numpy as np
    from PIL import Image

    import planescope as ps

    frame = ps.Recording(sample)[0]
    depth = out / "depth.png"
    Image.fromarray(frame.depth.astype(np.int32)).save(depth)  # 16-bit gray
    text = run("segment_image.py", depth, 385, 385, 319.5, 239.5)
    assert "stairs: 4 steps of 15 cm" in text and " 1  h" in text and "center of a foot" in text, text
    assert "focal length" in run("segment_image.py", depth, 0, 385, 319.5, 239.5, fails=True)
    run("segment_image.py", out / "none.png", 385, 385, 319.5, 239.5, fails=True)
    run("segment_image.py", fails=True)

    run("recording_table.py", sample, out / "table.csv")
    lines = (out / "table.csv").read_text().splitlines()
    assert lines[0].startswith("frame,id,label") and lines[-1].startswith("2,") and len(lines) > 20, lines
    assert "no such file" in run("recording_table.py", "/nowhere", fails=True)

    # A camera at rest: the same frame five times.
    still = out / "still" / "depth"
    still.mkdir(parents=True)
    for i in range(5):
        (still / f"{i:06}.png").write_bytes(depth.read_bytes())
    (still.parent / "intrinsics.txt").write_text("385 385 319.5 239.5 0.001 640 480\n")
    np.save(out / "poses.npy", np.stack([np.array(ps.segment(frame).T_world_sensor)] * 5))
    text = run("make_map.py", still.parent, out / "poses.npy")
    assert "h, " in text and "seen in 5 frames" in text, text
    np.save(out / "few.npy", np.eye(4)[None])
    assert "expected (5, 4, 4)" in run("make_map.py", still.parent, out / "few.npy", fails=True)

    text = run("live_loop.py", 6)
    assert "frame 5: T1 h" in text and "h, height 0.15 m" in text and "h, height 0.00 m" in text, text

    run("plot_planes.py", sample, out / "planes.png", 1)
    picture = np.asarray(Image.open(out / "planes.png"))
    assert picture.shape[:2] == (600, 1440) and picture[..., :3].std() > 10, picture.shape
    run("plot_planes.py", sample, out / "planes.png", 7, fails=True)
    try:
        import open3d  # noqa: F401

        run("plot_planes.py", sample, out / "planes.png", 1, out / "cloud.ply")
        assert (out / "cloud.ply").stat().st_size > 100000
    except ImportError:
        print("to Open3D: skipped, python3-open3d is not installed")

names = {"segment_image.py", "recording_table.py", "make_map.py", "live_loop.py", "plot_planes.py"}
assert {file.name for file in examples.glob("*.py")} == names, "an example has no test"
