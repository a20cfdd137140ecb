// mcap_test.mjs PROGRAM FOLDER SAMPLE: decodes every message that `segment` and `map` write into an
// MCAP file with the packages that Foxglove uses, and compares it with planes.json, cloud.ply and
// tracks.json of the same frames. FOLDER keeps the packages, from $npm_config_registry or npm's own
// registry. Exits 77 if they cannot be fetched.

import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import fs from "node:fs";
import { createRequire } from "node:module";
import path from "node:path";

const [program, folder, sample] = process.argv.slice(2).map((word) => path.resolve(word));
// With all that they depend on: npm itself would bring 400 Debian packages.
const packages = {
  "@foxglove/cdr": "3.5.0",
  "@foxglove/crc": "0.0.3",
  "@foxglove/message-definition": "0.5.0",
  "@foxglove/rosmsg": "5.0.5",
  "@foxglove/rosmsg2-serialization": "3.1.0",
  "@foxglove/rostime": "1.1.3",
  "@foxglove/wasm-zstd": "1.0.1",
  "@mcap/core": "2.2.2",
  "heap-js": "2.7.1",
  "md5-typescript": "1.0.5",
  tslib: "2.9.1",
};
fs.mkdirSync(folder, { recursive: true });
const require = createRequire(path.join(folder, "index.js"));
const registry = (process.env.npm_config_registry || "https://registry.npmjs.org").replace(/\/$/, "");
for (const [name, version] of Object.entries(packages)) {
  const place = path.join(folder, "node_modules", name);
  if (fs.existsSync(place) && JSON.parse(fs.readFileSync(path.join(place, "package.json"))).version === version) continue;
  const url = `${registry}/${name}/-/${name.split("/").pop()}-${version}.tgz`;
  const archive = path.join(folder, "package.tgz");
  try {
    execFileSync("curl", ["-fsSL", "--max-time", "60", "-o", archive, url], { stdio: "pipe" });
  } catch (error) {
    console.log(`skipped: npm registry: ${String(error.stderr || error).split("\n")[0]}, ${url}`);
    process.exit(77);
  }
  fs.rmSync(place, { recursive: true, force: true });
  fs.mkdirSync(`${place}.part`, { recursive: true });
  execFileSync("tar", ["-xzf", archive, "-C", `${place}.part`, "--strip-components=1"]);
  fs.renameSync(`${place}.part`, place);
}
const { McapIndexedReader } = require("@mcap/core");
const zstd = require("@foxglove/wasm-zstd");
const { parse } = require("@foxglove/rosmsg");
const { MessageReader, MessageWriter } = require("@foxglove/rosmsg2-serialization");

const scratch = fs.mkdtempSync(path.join(folder, "test-"));
process.on("exit", () => fs.rmSync(scratch, { recursive: true, force: true }));
const at = (...names) => path.join(scratch, ...names);
const run = (...words) => execFileSync(program, words, { encoding: "utf8", stdio: ["ignore", "pipe", "pipe"] });
const json = (...names) => JSON.parse(fs.readFileSync(at(...names), "utf8"));

/// Every message of a file: [{ topic, type, stamp, message }]. Checks that encoding it again yields the same bytes.
async function read(file) {
  const bytes = fs.readFileSync(file);
  const readable = {
    size: async () => BigInt(bytes.length),
    read: async (offset, size) => new Uint8Array(bytes.subarray(Number(offset), Number(offset + size))),
  };
  await zstd.isLoaded;
  const decompressHandlers = { zstd: (packed, size) => zstd.decompress(packed, Number(size)) };
  const reader = await McapIndexedReader.Initialize({ readable, decompressHandlers });
  assert.equal(reader.header.profile, "ros2");
  assert(reader.chunkIndexes.every((chunk) => chunk.compression === "zstd"));
  const coders = new Map();
  const messages = [];
  for await (const record of reader.readMessages()) {
    const channel = reader.channelsById.get(record.channelId);
    const schema = reader.schemasById.get(channel.schemaId);
    assert.equal(schema.encoding, "ros2msg");
    assert.equal(channel.messageEncoding, "cdr");
    if (!coders.has(schema.id)) {
      const definition = parse(new TextDecoder().decode(schema.data), { ros2: true });
      coders.set(schema.id, { reader: new MessageReader(definition), writer: new MessageWriter(definition) });
    }
    const { reader: decoder, writer } = coders.get(schema.id);
    const message = decoder.readMessage(record.data);
    assert.deepEqual(Buffer.from(writer.writeMessage(message)), Buffer.from(record.data), `${channel.topic} has other bytes`);
    messages.push({ topic: channel.topic, type: schema.name, stamp: record.logTime, latched: channel.metadata.has("offered_qos_profiles"), message });
  }
  const counts = [...reader.statistics.channelMessageCounts.values()].reduce((sum, count) => sum + Number(count), 0);
  assert.equal(counts, messages.length);
  assert.equal(Number(reader.statistics.messageCount), messages.length);
  return messages;
}

const list = ({ x, y, z }) => [x, y, z];
const near = (a, b, within, what) => {
  assert.equal(a.length, b.length, `${what}: ${a.length} of ${b.length}`);
  for (let i = 0; i < a.length; ++i) assert(Math.abs(a[i] - b[i]) <= within, `${what}: ${a[i]}, expected ${b[i]}`);
};
const edges = (ring) => ring.flatMap((corner, i) => [corner, ring[(i + 1) % ring.length]]);
const on = (messages, topic) => messages.filter((one) => one.topic === topic).map((one) => one.message);
/// Applies a geometry_msgs/Transform to a point.
function moved({ translation: t, rotation: q }, [x, y, z]) {
  const u = [q.x, q.y, q.z];
  const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
  const c = cross(u, [x, y, z]).map((value, i) => value + q.w * [x, y, z][i]);
  const d = cross(u, c);
  return [x + 2 * d[0] + t.x, y + 2 * d[1] + t.y, z + 2 * d[2] + t.z];
}

/// Points of a PointCloud2 by field.
function points(cloud) {
  const view = new DataView(cloud.data.buffer, cloud.data.byteOffset, cloud.data.byteLength);
  assert.equal(cloud.data.byteLength, cloud.width * cloud.point_step);
  const columns = {};
  for (const { name, offset, datatype } of cloud.fields) {
    const get = { 6: "getUint32", 7: "getFloat32" }[datatype];
    columns[name] = Array.from({ length: cloud.width }, (_, i) => view[get](i * cloud.point_step + offset, true));
  }
  return columns;
}

/// Vertices of cloud.ply by property.
function vertices(file) {
  const bytes = fs.readFileSync(file);
  const end = bytes.indexOf("end_header\n") + "end_header\n".length;
  const header = bytes.subarray(0, end).toString();
  assert(header.includes("binary_little_endian"));
  const sizes = { float: 4, int: 4, uchar: 1 };
  const properties = [...header.matchAll(/property (\w+) (\w+)/g)].map(([, kind, name]) => ({ kind, name }));
  const count = Number(header.match(/element vertex (\d+)/)[1]);
  const columns = Object.fromEntries(properties.map(({ name }) => [name, []]));
  for (let i = 0, place = end; i < count; ++i)
    for (const { kind, name } of properties) {
      columns[name].push(kind === "float" ? bytes.readFloatLE(place) : kind === "int" ? bytes.readInt32LE(place) : bytes[place]);
      place += sizes[kind];
    }
  return columns;
}

function checkPlanes(array, expected) {
  assert.equal(array.planes.length, expected.planes.length);
  array.planes.forEach((plane, k) => {
    const from = expected.planes[k];
    assert.equal(plane.id, from.id);
    assert.equal(plane.track, from.track ?? 0);
    assert.equal(plane.label, { unknown: 0, h: 1, v: 2 }[from.label]);
    near(list(plane.normal), from.normal, 0, "normal");
    near([plane.offset, plane.area], [from.offset_m, from.outline_area_m2], 0, "offset and area");
    assert.equal(plane.steppable, from.foot?.steppable ?? false);
    assert.equal(plane.outline.length, from.outline.length);
    plane.outline.forEach((part, i) => {
      near(part.outer.points.flatMap(list), from.outline[i].outer.flat(), 1e-6, "outline");
      for (const kind of ["holes", "unknown"])
        near(part[kind].flatMap((ring) => ring.points.flatMap(list)), from.outline[i][kind].flat(2), 1e-6, kind);
    });
    near(plane.places.flatMap((piece) => piece.points.flatMap(list)), (from.foot?.pieces ?? []).flat(2), 1e-6, "places");
  });
  for (const kind of ["flights", "kerbs", "ramps"]) assert.equal(array[kind].length, expected[kind].length, kind);
}

function checkMarkers({ markers }, expected) {
  assert.equal(markers[0].action, 3);
  assert(markers.slice(1).every((marker) => marker.action === 0 && marker.pose.orientation.w === 1));
  const keys = markers.slice(1).map((marker) => `${marker.ns} ${marker.id}`);
  assert.equal(new Set(keys).size, keys.length, "markers replace each other");
  const of = (ns) => markers.filter((marker) => marker.ns === ns);
  const marked = (ns, id) => of(ns).find((marker) => marker.id === id)?.points.flatMap(list) ?? [];
  for (const plane of expected.planes) {
    const { id } = plane;
    const known = plane.outline.flatMap(({ outer, holes }) => [outer, ...holes].flatMap(edges));
    near(marked("outline", id), known.flat(), 0, "outline");
    near(marked("unknown", id), plane.outline.flatMap(({ unknown }) => unknown.flatMap(edges)).flat(), 0, "unknown");
    const [from, to] = of("normal").find((marker) => marker.id === id).points.map(list);
    near(from, plane.surface.best_place, 0, "place of the normal");
    near(to, from.map((value, i) => value + 0.15 * plane.normal[i]), 2e-9, "normal");
    const name = `${plane.undecided ? "~" : ""}${plane.track ? `T${plane.track}` : `P${id}`}`;
    assert.equal(of("name").find((marker) => marker.id === id).text, name);
    near(marked("footholds", plane.id), (plane.foot?.pieces ?? []).flatMap(edges).flat(), 0, "footholds");
    // Triangles cover the outline's area.
    const corners = marked("surface", id);
    let area = 0;
    for (let i = 0; i < corners.length; i += 9) {
      const [a, b] = [3, 6].map((j) => [0, 1, 2].map((axis) => corners[i + j + axis] - corners[i + axis]));
      area += Math.hypot(a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]) / 2;
    }
    near([area], [plane.outline_area_m2], 1e-4, "area of the surface");
  }
  for (const ns of ["outline", "normal", "name"]) assert.equal(of(ns).length, expected.planes.length, ns);
  const nosings = [...expected.flights.map(({ steps }) => steps.flatMap(({ nosing }) => nosing)), ...expected.kerbs.map(({ nosing }) => nosing)];
  near(of("stairs").flatMap((marker) => marker.points.flatMap(list)), nosings.flat(2), 0, "nosings");
  assert.equal(of("ramps").length, expected.ramps.filter(({ plane }) => plane > 0).length);
}

function checkPoints(cloud, ply, tracks) {
  const found = points(cloud);
  for (const axis of ["x", "y", "z"]) near(found[axis], ply[axis], 0, axis);
  assert.deepEqual(found.plane, ply.instance);
  assert.equal(cloud.fields.some(({ name }) => name === "rgb"), true);
  if (tracks) assert.deepEqual(found.track, found.plane.map((id) => (id > 0 ? tracks[id - 1] : 0)));
}

/// Compares all frames of a file with the folder that `segment` writes.
function checkFrames(messages, dir, hasPoses) {
  const arrays = on(messages, "/planescope/planes");
  const frames = fs.readdirSync(at(dir, "frames")).sort();
  assert.equal(arrays.length, frames.length);
  frames.forEach((name, i) => {
    const expected = json(dir, "frames", name, "planes.json");
    const stamp = arrays[i].header.stamp;
    checkPlanes(arrays[i], expected);
    checkMarkers(on(messages, "/planescope/markers")[i], expected);
    checkPoints(on(messages, "/planescope/points")[i], vertices(at(dir, "frames", name, "cloud.ply")), expected.planes[0].track !== undefined && expected.planes.map(({ track }) => track));
    const [camera, world] = on(messages, "/tf")[i].transforms;
    assert.deepEqual([camera.header.frame_id, camera.child_frame_id], ["map", "camera_depth_optical_frame"]);
    assert.deepEqual([world.header.frame_id, world.child_frame_id], ["camera_depth_optical_frame", "planescope_world"]);
    const here = [0.3, -0.2, 1.1];
    near(moved(world.transform, moved(arrays[i].sensor, here)), here, 1e-9, "sensor and planescope_world");
    if (!hasPoses) near(moved(camera.transform, moved(world.transform, here)), here, 1e-9, "map and planescope_world");
    const depth = messages.filter((one) => one.topic.endsWith("depth/image_rect_raw") || one.topic.endsWith("to_color/image_raw"))[i].message;
    assert.equal(depth.encoding, "16UC1");
    for (const header of [depth.header, camera.header, on(messages, "/planescope/points")[i].header]) assert.deepEqual(header.stamp, stamp);
  });
  assert(messages.every((one, i) => i === 0 || one.stamp >= messages[i - 1].stamp));
}

const options = ["--foot", "0.08"];
run("segment", sample, ...options, "-o", at("frames"));
run("segment", sample, ...options, "-o", at("planes.mcap"), "--threads", "1");
run("segment", sample, ...options, "-o", at("again.mcap"), "--threads", "3");
assert(fs.readFileSync(at("planes.mcap")).equals(fs.readFileSync(at("again.mcap"))), "the bytes depend on threads");
const segmented = await read(at("planes.mcap"));
checkFrames(segmented, "frames", false);
for (const kind of ["flights", "ramps"]) assert(on(segmented, "/planescope/planes").some((array) => array[kind].length > 0), `no ${kind} in the sample`);

// A camera at rest: the sample's first frame, four times.
run("convert", sample, "--frames", "0", "-o", at("still"));
const facts = json("still", "planescope.json");
facts.frames = [0, 1, 2, 3].map((i) => ({ ...facts.frames[0], name: `00000${i}`, timestamp_s: 100 + i / 10 }));
fs.writeFileSync(at("still", "planescope.json"), JSON.stringify(facts));
for (const images of ["depth", "color"]) for (const i of [1, 2, 3]) fs.copyFileSync(at("still", images, "000000.png"), at("still", images, `00000${i}.png`));
run("map", at("still"), "-o", at("map"));
run("segment", at("still"), "--map", at("map"), "-o", at("mapped"));
run("map", at("still"), "-o", at("map.mcap"));
const mapped = await read(at("map.mcap"));
checkFrames(mapped, "mapped", true);
const { planes } = json("map", "map.json");
const world = on(mapped, "/planescope/map")[0].markers;
assert.equal(world[0].action, 3);
const alive = planes.filter(({ state }) => state === "alive").map(({ track }) => track);
assert.deepEqual(world.filter(({ ns }) => ns === "name").map(({ text }) => text).sort(), alive.map((id) => `T${id}`).sort());
assert(mapped.filter(({ topic }) => /map|path/.test(topic)).every(({ latched }) => latched));
const colors = new Map();
for (const { markers } of [...on(mapped, "/planescope/map"), ...on(mapped, "/planescope/markers")])
  for (const { ns, text, id } of markers)
    if (ns === "name" && /T\d/.test(text)) {
      const { r, g, b } = markers.find((marker) => marker.ns === "outline" && marker.id === id).color;
      const color = `${r} ${g} ${b}`;
      const track = text.replace("~", "");
      assert.equal(colors.get(track) ?? color, color, `${track} changes its color`);
      colors.set(track, color);
    }
const poses = fs.readFileSync(at("map", "poses.tum"), "utf8").split("\n").filter((line) => line && !line.startsWith("#")).map((line) => line.split(" ").map(Number));
const way = on(mapped, "/planescope/path")[0].poses;
near(way.flatMap(({ pose }) => list(pose.position)), poses.flatMap((numbers) => numbers.slice(1, 4)), 1e-9, "path");
console.log(`${segmented.length} and ${mapped.length} messages decoded and compared`);
