"""ros_test.py MESSAGES: the output of --ros-json has exactly the fields of the message definitions."""

import json
import os
import re
import subprocess
import sys
from pathlib import Path

definitions = Path(sys.argv[1])
sample = sys.argv[2]

# Messages of ROS that ours contain.
KNOWN = {
    "std_msgs/Header": [("builtin_interfaces/Time", "stamp"), ("string", "frame_id")],
    "builtin_interfaces/Time": [("int32", "sec"), ("uint32", "nanosec")],
    "geometry_msgs/Vector3": [("float64", "x"), ("float64", "y"), ("float64", "z")],
    "geometry_msgs/Point": [("float64", "x"), ("float64", "y"), ("float64", "z")],
    "geometry_msgs/Point32": [("float32", "x"), ("float32", "y"), ("float32", "z")],
    "geometry_msgs/Quaternion": [("float64", "x"), ("float64", "y"), ("float64", "z"), ("float64", "w")],
    "geometry_msgs/Transform": [
        ("geometry_msgs/Vector3", "translation"), ("geometry_msgs/Quaternion", "rotation"),
    ],
    "geometry_msgs/Polygon": [("geometry_msgs/Point32[]", "points")],
}


def fields_of(kind):
    """Fields of a message: [(type, name)]."""
    if kind in KNOWN:
        return KNOWN[kind]
    fields = []
    for line in (definitions / "msg" / f"{kind}.msg").read_text().splitlines():
        line = line.split("#")[0].strip()
        if line and "=" not in line:
            fields.append(tuple(line.split()))
    return fields


def check(kind, value, where):
    if array := re.fullmatch(r"(.*)\[(\d*)\]", kind):
        assert isinstance(value, list), f"{where}: no list"
        assert not array[2] or len(value) == int(array[2]), f"{where}: {len(value)} of {array[2]}"
        for i, one in enumerate(value):
            check(array[1], one, f"{where}[{i}]")
    elif kind == "bool":
        assert isinstance(value, bool), f"{where}: {value!r} is no bool"
    elif kind == "string":
        assert isinstance(value, str), f"{where}: {value!r} is no string"
    elif number := re.fullmatch(r"(u?)int(\d+)", kind):
        least, most = (0, 2 ** int(number[2])) if number[1] else (-(2 ** (int(number[2]) - 1)), 2 ** (int(number[2]) - 1))
        assert isinstance(value, int) and not isinstance(value, bool), f"{where}: {value!r} is no {kind}"
        assert least <= value < most, f"{where}: {value} is no {kind}"
    elif kind.startswith("float"):
        assert isinstance(value, (int, float)) and not isinstance(value, bool), f"{where}: {value!r}"
    else:
        fields = fields_of(kind)
        assert [name for _, name in fields] == list(value), f"{where}: {kind} has other fields than {list(value)}"
        for field, name in fields:
            check(field, value[name], f"{where}.{name}")


def messages_of(*options):
    ran = subprocess.run(
        [os.environ["PLANESCOPE_PROGRAM"], "segment", sample, "--ros-json", *options], check=True, capture_output=True, text=True
    )
    return [json.loads(line) for line in ran.stdout.splitlines()]


messages = messages_of("--foot", "0.08")
assert len(messages) == 3, len(messages)
for i, message in enumerate(messages):
    check("PlaneArray", message, f"frame {i}")
for list_of in ("planes", "flights", "ramps"):
    assert any(message[list_of] for message in messages), f"no {list_of} in the sample"
assert any(plane["places"] for plane in messages[0]["planes"])
assert any(plane["outline"][0]["holes"] or plane["outline"][0]["unknown"] for message in messages for plane in message["planes"])
for message in messages:
    for plane in message["planes"]:
        normal, offset = plane["normal"], plane["offset"]
        for point in plane["outline"][0]["outer"]["points"]:
            assert abs(sum(normal[axis] * point[axis] for axis in "xyz") - offset) < 1e-5
none = messages_of("--gravity", "none", "--frames", "0")
check("PlaneArray", none[0], "without gravity")
assert not none[0]["gravity_known"] and {plane["label"] for plane in none[0]["planes"]} == {0}

listed = set(re.findall(r"msg/(\w+)\.msg", (definitions / "CMakeLists.txt").read_text()))
assert listed == {file.stem for file in (definitions / "msg").glob("*.msg")}, listed
