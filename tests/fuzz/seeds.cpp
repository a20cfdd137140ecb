// What fuzzing begins with: small good files, none of them recorded anywhere.

#include <bit>
#include <fstream>
#include <iterator>
#include <map>

#include "core/debug/filter/filter.hpp"
#include "core/io/cloud_files/cloud_file.hpp"
#include "core/io/image/png.hpp"
#include "core/io/picked_gravity.hpp"
#include "core/io/readers.hpp"
#include "core/labels/edit/edit.hpp"
#include "core/labels/exchange/exchange.hpp"
#include "core/labels/model/label_files.hpp"
#include "core/labels/store/store.hpp"
#include "core/planes/classify/weights.hpp"
#include "core/planes/pipeline/options_table.hpp"
#include "core/report/compare/rules.hpp"
#include "core/report/data/report_files.hpp"
#include "core/report/data/report_json.hpp"
#include "fuzz/fuzz.hpp"
#include "support/empty_report.hpp"
#include "support/jpeg_bytes.hpp"
#include "unit/io/ros2_writer.hpp"
#include "unit/io/sample_bags.hpp"

namespace planescope::fuzz {

namespace fs = std::filesystem;

Frame sample_frame() {
  Frame frame;
  frame.name = "sample";
  frame.depth = Image16(kWidth, kHeight);
  frame.depth_unit_m = 0.001;
  frame.intrinsics = {kWidth, kHeight, 8, 8, kWidth / 2.0, kHeight / 2.0};
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x)
      frame.depth.at(x, y) = static_cast<std::uint16_t>(y < 4 ? 1000 : 1000 - 100 * (y - 3));
  frame.depth.at(0, 0) = 0;
  return frame;
}

Image16 plain_depth() { return Image16(24, 16, 1, 1000); }

const labels::LabelGrid& label_grid() {
  static const labels::LabelGrid grid = labels::make_label_grid(sample_frame(), Gravity{});
  return grid;
}

FrameLabels blank_labels(int frame) {
  return labels::empty_labels(label_grid(), std::string(64, static_cast<char>('a' + frame)));
}

ByteVector bytes_of_file(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

namespace {

ByteVector bytes_of(const std::string& text) { return {text.begin(), text.end()}; }

struct Seeds {
  fs::path folder;

  void add(const std::string& target, const std::string& name, const ByteVector& bytes) const {
    fs::create_directories(folder / target);
    std::ofstream file(folder / target / name, std::ios::binary);
    file.write(reinterpret_cast<const char*>(bytes.data()),
               static_cast<std::streamsize>(bytes.size()));
    require(file.flush().good(), "cannot write into " + folder.string());
  }
  void add(const std::string& target, const std::string& name, const std::string& text) const {
    add(target, name, bytes_of(text));
  }
};

FrameLabels drawn_labels() {
  FrameLabels drawn = blank_labels(0);
  for (int id = 1; id <= 2; ++id) {
    LabelPlane plane;
    plane.id = id;
    plane.label = id == 1 ? Label::v : Label::h;
    drawn.planes.push_back(plane);
  }
  for (int y = 0; y < kHeight; ++y)
    for (int x = 1; x < kWidth; ++x) {
      drawn.plane.at(x, y) = y < 4 ? 1 : 2;
      drawn.hv.at(x, y) = y < 4 ? 2 : 1;
    }
  drawn.plane.at(7, 0) = kPlaneIgnore;
  drawn.hv.at(7, 0) = kHvIgnore;
  drawn.review.push_back({.pixel = 3, .pixels = 4, .label_plane = 1, .reviewer = "bob"});
  return drawn;
}

void add_bags(const Seeds& seeds) {
  using namespace testing_bags;
  for (const char* compression : {"none", "lz4", "bz2"}) {
    SdkBag options;
    options.frames = 2;
    options.format.compression = compression;
    options.sdk_2_49 = compression == std::string("lz4");
    BagWriter bag = sdk_bag(options);
    bag.add(kSdkAccel + "/imu/data", "sensor_msgs/Imu", 5'000'000,
            imu_message(1, 500, {0, -9.8, 0}));
    seeds.add("bag", std::string("sdk_") + compression, bag.finish());
  }
  const std::string camera = "/camera";
  BagWriter ros({"none", false, true, true, 4});
  ros.add("/tf_static", "tf2_msgs/TFMessage", 1, tf_message("a", "b", Pose::Identity()));
  ros.add(camera + "/extrinsics/depth_to_color", "realsense2_camera/Extrinsics", 1,
          extrinsics_message(Pose::Identity()));
  ros.add(camera + "/depth/camera_info", "sensor_msgs/CameraInfo", 1,
          camera_info_message(testing_bags::kWidth, testing_bags::kHeight, {20, 21, 12, 8},
                              "plumb_bob", {0.1, 0, 0, 0, 0}));
  auto depth = depth_message(1, 500);
  depth.encoding = "16UC1";
  ros.add(camera + "/depth/image_rect_raw", "sensor_msgs/Image", 2, image_message(depth));
  auto color = color_message(1, 500);
  color.encoding = "bgr8";
  ros.add(camera + "/color/camera_info", "sensor_msgs/CameraInfo", 1,
          camera_info_message(testing_bags::kWidth, testing_bags::kHeight, {20, 21, 12, 8}));
  ros.add(camera + "/color/image_raw", "sensor_msgs/Image", 3, image_message(color));
  ros.add(camera + "/accel/sample", "sensor_msgs/Imu", 3, imu_message(1, 500, {0, -9.8, 0}));
  seeds.add("bag", "ros", ros.finish());
}

void add_ros2_recordings(const Seeds& seeds) {
  using namespace testing_bags;
  fs::create_directories(memory_folder() / "seeds");
  const fs::path path = memory_folder() / "seeds" / "a";
  write_db3(path, sdk_messages(1), 512);
  seeds.add("db3", "sdk", bytes_of_file(path));
  write_db3(path, packed(realsense_ros_messages(1)), 512);
  seeds.add("db3", "ros_zstd", bytes_of_file(path));
  Ros2Messages ros = realsense_ros_messages(4);
  const Image16 depth = depth_of(100);
  const std::pair<const char*, ByteVector> forms[] = {
      {"16UC1; compressedDepth png", with_config(io::encode_png(depth))},
      {"16UC1; compressedDepth rvl", with_config(rvl_packed(depth))},
      {"16UC1; png", io::encode_png(depth)},
      {"16UC1; zstd", zstd_transport(depth)}};
  int frame = 0;
  for (Ros2Message& message : ros) {
    if (!message.topic.ends_with("/image_rect_raw")) continue;
    const auto& [format, bytes] = forms[frame++];
    message.type = "sensor_msgs/msg/CompressedImage";
    message.bytes = cdr_compressed_image(1'700'000'000, "depth_optical", format, bytes);
  }
  for (const std::string compression : {"", "lz4", "zstd"}) {
    write_mcap(path, ros, {compression, 7, compression != "lz4", "cdr"});
    seeds.add("mcap", "ros_" + (compression.empty() ? "plain" : compression), bytes_of_file(path));
  }
}

void add_images(const Seeds& seeds) {
  seeds.add("png", "depth", io::encode_png(sample_frame().depth));
  for (const int channels : {1, 3, 4})
    seeds.add("png", "channels_" + std::to_string(channels),
              io::encode_png(Image8(kWidth, kHeight, channels, 100)));
  seeds.add("jpeg", "color", encode_jpeg(kWidth, kHeight, true));
}

void add_clouds(const Seeds& seeds) {
  PointSet set;
  for (int i = 0; i < 60; ++i)
    set.points.emplace_back(0.05f * static_cast<float>(i % 10), 0.05f * static_cast<float>(i / 10),
                            1.0f);
  const std::string ascii =
      "ply\nformat ascii 1.0\ncomment a\nelement vertex 2\nproperty double x\nproperty double y\n"
      "property double z\nproperty uchar red\nproperty uchar green\nproperty uchar blue\n"
      "property int label\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n"
      "1 2 3 4 5 6 1\n-1e3 .5 nan 0 255 7 2\n3 0 1 1\n";
  seeds.add("ply", "plain", io::ply_bytes(set));
  seeds.add("planes_in_cloud", "plain", io::ply_bytes(set));
  seeds.add("pcd", "plain", io::pcd_bytes(set));
  set.points.resize(4);
  set.rgb.assign(12, 200);
  set.label = {0, 1, 2, 1};
  set.instance = {0, 1, 2, 1};
  for (const double origin_m : {0.0, 1e6}) {
    set.origin.x() = origin_m;
    const io::IntField u{"u", {1, 2, 3, 4}};
    const std::string name = origin_m > 0 ? "far" : "labelled";
    seeds.add("ply", name, io::ply_bytes(set, {&u, 1}));
    seeds.add("pcd", name, io::pcd_bytes(set, {&u, 1}));
    seeds.add("planes_in_cloud", name, io::ply_bytes(set));
  }
  seeds.add("ply", "ascii", ascii);
  const std::string fields =
      "# .PCD v0.7\nVERSION 0.7\nFIELDS x y z rgb intensity\nSIZE 4 4 4 4 2\nTYPE F F F F U\n"
      "COUNT 1 1 1 1 1\nWIDTH 2\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS 2\nDATA ";
  seeds.add("pcd", "ascii", fields + "ascii\n1 2 3 4.2e6 5\nnan nan nan 0 0\n");
  // Both points by field, as LZF packs them: one run of 32 literals, one of four.
  ByteVector packed = bytes_of(fields + "binary_compressed\n");
  packed.insert(packed.end(), {38, 0, 0, 0, 36, 0, 0, 0, 31});
  packed.insert(packed.end(), 32, 0);
  packed.push_back(3);
  packed.insert(packed.end(), 4, 1);
  seeds.add("pcd", "compressed", packed);
}

void add_cameras(const Seeds& seeds) {
  seeds.add("viewer_raw", "depth",
            std::string("Frame Info: \nType,Depth\nFormat,Z16\nFrame Number,531\n"
                        "Timestamp (ms),1000.5\nResolution x,24\nResolution y,16\n"
                        "Bytes per pixel,2\nIntrinsic:,\nFx,20.5\nFy,20\nPPx,12\nPPy,8\n"
                        "Distorsion,Brown Conrady\n"));
  seeds.add("camera_json", "open3d", std::string(R"({"width": 12, "height": 8, "depth_scale": 1000,
                        "intrinsic_matrix": [10, 0, 0, 0, 11, 0, 6, 4, 1]})"));
  seeds.add(
      "camera_json", "rows",
      std::string(R"({"intrinsic": {"intrinsic_matrix": [[10, 0, 6], [0, 11, 4], [0, 0, 1]]}})"));
  seeds.add("camera_json", "realsense", std::string(R"({"fx": 10, "fy": 11, "ppx": 6, "ppy": 4})"));
  const auto matrix = [](const std::string& name, const std::string& numbers) {
    return "<" + name + " type_id=\"opencv-matrix\"><rows>3</rows><cols>3</cols><dt>d</dt><data>" +
           numbers + "</data></" + name + ">";
  };
  seeds.add("camera_xml", "stereo",
            "<?xml version=\"1.0\"?><opencv_storage>" +
                matrix("IR_camera", "10. 0. 6. 0. 11. 4. 0. 0. 1.") +
                matrix("IR_distortion", "0.1 0. 0. 0. 0.") +
                matrix("RGB_camera", "10. 0. 6. 0. 11. 4. 0. 0. 1.") +
                matrix("Rotation", "1. 0. 0. 0. 1. 0. 0. 0. 1.") +
                matrix("Translation", "25. 0. 0.") + "</opencv_storage>");
  seeds.add("camera_text", "four", std::string("# fx, fy, cx, cy\n10., 11., 6., 4.\n"));
  seeds.add("camera_text", "matrix", std::string("10 0 6 0\n0 -11 4 0\n0 0 1 0\n0 0 0 1\n"));
  seeds.add("sidecar", "full",
            std::string(R"({"schema": "planescope.recording/1", "intrinsics": {"width": 24,
                        "height": 16, "fx": 20, "fy": 20, "cx": 12, "cy": 8,
                        "distortion": [0.1, 0, 0, 0, 0]}, "depth_unit_m": 0.001,
                        "gravity": [0, 1, 0], "color_aligned": true, "frames":
                        [{"name": "000000", "timestamp_s": 1.5, "gravity": [0, 1, 0.1]}]})"));
  const io::PickedDirection picked{
      Vec3d::UnitY(), {Vec3d::UnitZ()}, 0, io::sha256_of_depth(plain_depth()), "a wall"};
  io::write_picked_gravity(memory_folder() / "seeds", {picked, {{0, picked}}});
  seeds.add("gravity", "picked", bytes_of_file(memory_folder() / "seeds" / "gravity.json"));
}

void add_labels(const Seeds& seeds) {
  const FrameLabels drawn = drawn_labels();
  seeds.add("label_json", "drawn", labels::label_json(0, drawn));
  const fs::path dir = memory_folder() / "seeds";
  {
    std::int64_t now_ms = 0;
    labels::LabelStore store(dir, {"ann", [&] { return now_ms += 5000; }});
    store.open(0, blank_labels(0));
    store.open(1, blank_labels(1));
    store.commit(labels::make_edit(0, "draw", *store.labels(0), drawn));
    FrameLabels erased = drawn;
    erased.planes.pop_back();
    for (std::size_t i = 0; i < erased.plane.data.size(); ++i)
      if (erased.plane.data[i] == 2) erased.plane.data[i] = erased.hv.data[i] = 0;
    store.commit(labels::make_edit(0, "erase", drawn, erased));
    store.undo();
    store.save(0);
    store.redo();
    FrameLabels other = drawn;
    other.depth_sha256 = store.labels(1)->depth_sha256;
    store.commit(labels::make_edit(1, "draw", *store.labels(1), other));
    store.undo();
  }
  seeds.add("journal", "two_frames", bytes_of_file(dir / "journal"));
  const labels::LabelledPoints points = labels::points_of_labels(drawn, label_grid());
  using labels::LabelFormat;
  for (const auto& [target, format] :
       {std::pair("npy", LabelFormat::evops), std::pair("npz", LabelFormat::npz),
        std::pair("coco", LabelFormat::coco), std::pair("kitti", LabelFormat::kitti),
        std::pair("label_ply", LabelFormat::ply)}) {
    const auto paths = labels::write_labelled(dir / "a", format, points);
    seeds.add(target, "drawn", bytes_of_file(paths.back()));
  }
}

void add_reports(const Seeds& seeds) {
  report::Report report = empty_report();
  report.options.resize(2);
  report::ReportRecording& recording = report.recordings.emplace_back();
  recording.name = "rec";
  report::ReportFrame frame;
  frame.index = 7;
  frame.name = "000007";
  frame.sha256 = std::string(64, 'a');
  frame.counts.kept = 50;
  for (int id = 1; id <= 2; ++id) {
    planes::PlaneSummary plane;
    plane.id = id;
    plane.label = id == 1 ? Label::h : Label::v;
    plane.normal = {0, id - 1.0, 2.0 - id};
    plane.area_m2 = 0.5;
    plane.points = 20;
    frame.planes.push_back({plane, "#0072b2"});
  }
  frame.regions = {8, 3, 2, {{-1, 1}, {1, 2}, {2, 1}, {0, 2}}};
  frame.metrics = planes::Metrics{};
  recording.frames.push_back(frame);
  report::ReportFrame& refused = recording.frames.emplace_back();
  refused.index = 8;
  refused.refused = "no gravity";
  seeds.add("report", "two_frames", report::report_json(report));
  const fs::path dir = memory_folder() / "seeds";
  report::write_frame_record(dir, frame, true, "key");
  seeds.add("frame_record", "frame", bytes_of_file(dir / "frame.json"));
  seeds.add("rules", "built_in", report::rules_json(report::built_in_rules()));
  for (const char* target : {"report.json", "a.json#f12", "a.json#r2/f12/was3"})
    seeds.add("report_target", std::string("like_") + std::to_string(std::string(target).size()),
              std::string(target));
}

void add_texts(const Seeds& seeds) {
  planes::NetworkWeights weights;
  weights.config = {.name = "tiny", .levels = {{2, 2}, {3}}, .neighbours = 4, .head = {2}};
  for (const planes::TensorSpec& spec : planes::tensor_specs(weights.config)) {
    std::size_t count = 1;
    for (const int size : spec.shape) count *= static_cast<std::size_t>(size);
    weights.tensors.emplace_back(count, 0.5f);
  }
  const fs::path path = memory_folder() / "seeds" / "tiny.safetensors";
  planes::write_weights(path, weights);
  seeds.add("weights", "tiny", bytes_of_file(path));

  seeds.add("json", "all", std::string(R"({"a": [1, -2.5e3, true, null, "b\u00e9"], "c": {}})"));
  std::string names;
  for (const debug::FilterName& name : debug::filter_names())
    names += (names.empty() ? "" : " || ") + name.name + " == 1";
  seeds.add("filter", "names", names);
  seeds.add("filter", "case", std::string("case==III && depth>=5 && mse>0.8*theta_mse"));
  seeds.add("filter", "signs", std::string("!(visit||decide) && -offset < (P7-1.5e-2)/4"));
  std::map<std::string, std::string> options;
  for (const planes::OptionInfo& info : planes::option_table())
    options[info.section] += info.name + "=" + info.get({}) + "\n";
  for (const auto& [section, lines] : options) seeds.add("options", section, lines);
  seeds.add("options", "gravity", std::string("0,1,0\nauto\nnone\n"));

  ByteVector depth = {kWidth - 1};
  const auto put = [&](std::initializer_list<double> values) {
    for (const double value : values)
      for (int i = 0; i < 8; ++i)
        depth.push_back(static_cast<unsigned char>(std::bit_cast<std::uint64_t>(value) >> (8 * i)));
  };
  put({0.001, 8.0, 8.0, 4.0, 3.0});
  depth.push_back(0);
  put({0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0});
  for (const std::uint16_t count : sample_frame().depth.data)
    depth.insert(depth.end(),
                 {static_cast<unsigned char>(count & 255), static_cast<unsigned char>(count >> 8)});
  seeds.add("planes_in_depth", "wall", depth);
}

}  // namespace

void write_seeds(const fs::path& folder) {
  fs::create_directories(memory_folder() / "seeds");
  const Seeds seeds{folder};
  add_bags(seeds);
  add_ros2_recordings(seeds);
  add_images(seeds);
  add_clouds(seeds);
  add_cameras(seeds);
  add_labels(seeds);
  add_reports(seeds);
  add_texts(seeds);
}

}  // namespace planescope::fuzz
