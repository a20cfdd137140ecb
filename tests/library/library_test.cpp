// Tests of the public library through its public headers.

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <memory>
#include <planescope/io.hpp>
#include <planescope/render.hpp>
#include <thread>
#include <type_traits>
#include <utility>

namespace {

namespace ps = planescope;

/// A level camera 30 cm above a floor, with a step of 15 cm 1 m ahead.
struct Step {
  std::vector<std::uint16_t> counts;
  ps::DepthImage image;

  Step() {
    image.camera.width = 424;
    image.camera.height = 240;
    image.camera.fx = image.camera.fy = 300;
    image.camera.cx = 211.5;
    image.camera.cy = 119.5;
    image.gravity = ps::Vec3{0, 2, 0};
    for (int v = 0; v < 240; ++v)
      for (int u = 0; u < 424; ++u) {
        const double down = (v - 119.5) / 300;
        const double z = down > 0.3    ? 0.30 / down
                         : down > 0.15 ? 1.0
                         : down > 0.05 ? 0.15 / down
                                       : 0;
        counts.push_back(static_cast<std::uint16_t>(std::lround(z * 1000)));
      }
    image.counts = counts.data();
  }
};

std::string error_of(const std::function<void()>& call) {
  try {
    call();
  } catch (const ps::Error& error) {
    return error.what();
  }
  return "";
}

TEST(Library, FindsTheFloorTheTreadAndTheRiserOfAStep) {
  const Step step;
  const ps::Result result = ps::segment(step.image);
  ASSERT_EQ(result.planes().size(), 3U);
  int risers = 0, treads = 0, floors = 0;
  for (const ps::Plane& plane : result.planes()) {
    risers += plane.label == ps::Label::v && std::abs(plane.tilt_deg - 90) < 1;
    treads += std::abs(plane.height_m - 0.15) < 0.002;
    floors += std::abs(plane.height_m) < 0.002;
    ASSERT_FALSE(plane.outline.parts.empty());
    const ps::Vec3 corner = plane.outline.world(plane.outline.parts[0].outer[0]);
    EXPECT_NEAR(
        corner[0] * plane.normal[0] + corner[1] * plane.normal[1] + corner[2] * plane.normal[2],
        plane.offset_m, 1e-6);
    double area = 0;
    const ps::Mesh mesh = result.mesh(plane.id);
    for (const auto& t : mesh.triangles) {
      const ps::Vec3 &a = mesh.vertices[t[0]], &b = mesh.vertices[t[1]], &c = mesh.vertices[t[2]];
      const ps::Vec3 ab = {b[0] - a[0], b[1] - a[1], b[2] - a[2]};
      const ps::Vec3 ac = {c[0] - a[0], c[1] - a[1], c[2] - a[2]};
      area += std::hypot(ab[1] * ac[2] - ab[2] * ac[1], ab[2] * ac[0] - ab[0] * ac[2],
                         ab[0] * ac[1] - ab[1] * ac[0]) /
              2;
    }
    EXPECT_NEAR(area, plane.outline.area_m2, 1e-4);
  }
  EXPECT_EQ(risers, 1);
  EXPECT_EQ(treads, 1);
  EXPECT_EQ(floors, 1);
  // The bottom pixel is on the floor, 30 cm below the sensor.
  const std::size_t bottom = 239 * 424 + 212;
  const int id = result.plane_of()[bottom];
  ASSERT_GT(id, 0);
  EXPECT_NEAR(result.planes()[static_cast<std::size_t>(id) - 1].height_m, 0, 0.002);
  EXPECT_NEAR(result.points()[bottom][2], -0.30, 0.002);
  EXPECT_EQ(result.plane_of()[0], 0);
  EXPECT_TRUE(std::isnan(result.points()[0][0]));
  EXPECT_EQ(result.gravity().source, "option");
}

TEST(Library, APartOfAnImageIsSegmentedInPlace) {
  const Step step;
  ps::DepthImage part = step.image;  // its lower right quarter
  part.row_stride = 424;
  part.counts += 120 * 424 + 212;
  part.camera.width = 212;
  part.camera.height = 120;
  part.camera.cx -= 212;
  part.camera.cy -= 120;
  const ps::Result result = ps::segment(part);
  EXPECT_EQ(result.plane_of().size(), 212U * 120);
  EXPECT_EQ(result.planes().size(), 3U);
}

TEST(Library, DepthInMetersIsStoredWithNegligibleLoss) {
  Step step;
  std::vector<float> meters;
  for (const std::uint16_t count : step.counts) meters.push_back(0.001f * count);
  meters[0] = std::nanf("");
  ps::DepthImage image = step.image;
  image.counts = nullptr;
  image.meters = meters.data();
  EXPECT_EQ(ps::Frame(image).bytes(), ps::Frame(step.image).bytes());
  for (float& z : meters) z *= 1.00037f;  // no longer whole numbers of units
  meters[1] = 100;                        // beyond the range of counts
  const ps::Frame frame(image);
  const ps::DepthImage stored = frame.depth();
  EXPECT_EQ(stored.counts[1], 65535);
  for (std::size_t i = 2; i < meters.size(); ++i)
    ASSERT_NEAR(stored.counts[i] * stored.unit_m, meters[i], 1.001e-4) << i;
}

TEST(Library, AFrameSurvivesSerialization) {
  const ps::Recording recording(PLANESCOPE_SAMPLE);
  const ps::Frame frame = recording[1];
  const std::string bytes = frame.bytes();
  const ps::Frame again = ps::Frame::from_bytes(bytes);
  EXPECT_EQ(again.bytes(), bytes);
  EXPECT_EQ(ps::segment(again).json(), ps::segment(frame).json());
  const std::string damaged = "frame: damaged bytes; expected the output of Frame::bytes()";
  for (const std::string& wrong :
       {std::string(), bytes.substr(1), bytes.substr(0, bytes.size() - 1), bytes + "x"})
    EXPECT_EQ(error_of([&] { ps::Frame::from_bytes(wrong); }), damaged);
}

TEST(Library, AMapperFollowsPlanesFromFrameToFrame) {
  const Step step;
  // The camera looks along x.
  ps::Transform pose = {0, 0, 1, 0, -1, 0, 0, 0, 0, -1, 0, 0.3, 0, 0, 0, 1};
  ps::Mapper mapper(ps::Segmenter(), 6);
  EXPECT_EQ(error_of([&] { mapper.map(); }), "map: no frames; expected at least one from add()");
  EXPECT_EQ(error_of([&] { mapper.add(step.image, ps::kIdentity); }),
            "pose of frame 0: the frame's gravity is 90 deg off; expected a world frame with z up");
  std::vector<int> tracks;
  for (int i = 0; i < 4; ++i) {
    const ps::MappedFrame added = mapper.add(step.image, pose);
    EXPECT_FALSE(added.set_aside);
    ASSERT_EQ(added.tracks.size(), added.result.planes().size());
    if (i == 0) tracks = added.tracks;
    EXPECT_EQ(added.tracks, tracks);
  }
  EXPECT_EQ(mapper.size(), 4);
  const ps::Map map = mapper.map();
  EXPECT_EQ(map.pose_frames, (std::vector{0, 1, 2, 3}));
  EXPECT_NE(map.map_json.find("\"seen\": 4"), std::string::npos) << map.map_json;
}

TEST(Library, ReportsErrorsInOneLine) {
  const Step step;
  const auto with = [&](const std::function<void(ps::DepthImage&)>& change) {
    ps::DepthImage image = step.image;
    change(image);
    return error_of([&] { ps::segment(image); });
  };
  EXPECT_EQ(with([](auto& i) { i.counts = nullptr; }), "depth image: no pixels");
  EXPECT_EQ(with([](auto& i) { i.camera.fx = 0; }),
            "depth image: focal length 0, 300 px; expected values above 0");
  EXPECT_EQ(
      with([](auto& i) { i.camera.fx = i.camera.fy = 1; }),
      "depth image: focal length 1, 1 px for 424x240 pixels, a field of view of more than 160 "
      "degrees; expected fx, fy, cx, and cy in pixels");
  EXPECT_EQ(with([](auto& i) { i.camera.width = -1; }),
            "depth image: -1x240 pixels; expected 1 to 16384 in each direction");
  EXPECT_EQ(with([](auto& i) { i.unit_m = 1000; }),
            "depth image: 1000 m per count; expected more than 0 and at most 1");
  EXPECT_EQ(with([](auto& i) { i.row_stride = 3; }),
            "depth image: row stride 3; expected at least the width, 424");
  EXPECT_EQ(with([](auto& i) {
              i.gravity = ps::Vec3{0, 0, 0};
            }),
            "gravity: 0, 0, 0; expected a nonzero direction");
  EXPECT_EQ(with([](auto& i) { i.camera.distortion = static_cast<ps::Distortion>(7); }),
            "depth image: unknown distortion 7; expected 0 to 2");
  EXPECT_EQ(with([](auto& i) {
              i.camera.distortion = ps::Distortion::brown_conrady;
              i.camera.coefficients[2] = std::nan("");
            }),
            "depth image: distortion coefficient nan; expected a finite number");
  const std::vector<std::uint8_t> rgb(300);
  EXPECT_EQ(with([&](auto& i) {
              i.color.rgb = rgb.data();
              i.color.aligned = true;
              i.color.camera.width = i.color.camera.height = 10;
            }),
            "color image: 10x10 pixels, aligned with depth; expected 424x240");
  EXPECT_EQ(error_of([] { ps::Recording(std::string("a\0b", 3)); }),
            "recording: the path contains a NUL character");
  EXPECT_EQ(error_of([&] { ps::segment(ps::PointCloud()); }), "point cloud: no points");
  EXPECT_EQ(error_of([] { ps::Segmenter(ps::Options(), 0); }), "threads: 0; expected 1 or more");
  EXPECT_EQ(error_of([] { ps::Recording("/nowhere"); }), "/nowhere: no such file or folder");
  EXPECT_EQ(error_of([] { ps::Recording(PLANESCOPE_SAMPLE)[3]; }), PLANESCOPE_SAMPLE
            ": frame 3 is out of range; the recording has 3 frames, numbered from 0");
  const std::string unknown = error_of([] { ps::Options().set("theta_n_ou", "3"); });
  EXPECT_NE(unknown.find("theta_n_out"), std::string::npos) << unknown;
  // Errors do not suggest options of the command line.
  std::vector<std::uint16_t> nothing(64 * 48);
  ps::DepthImage empty = step.image;
  empty.camera.width = 64;
  empty.camera.height = 48;
  empty.counts = nothing.data();
  empty.gravity.reset();
  const std::string where = error_of([&] { ps::segment(empty); });
  EXPECT_NE(where.find("contains no depth: all pixels are 0"), std::string::npos) << where;
  EXPECT_EQ(where.find("--"), std::string::npos) << where;
}

TEST(Library, PlanesOfATemporaryResultAreCopied) {
  const Step step;
  double area = 0;
  for (const ps::Plane& plane : ps::segment(step.image).planes()) area += plane.outline.area_m2;
  EXPECT_GT(area, 1);
  EXPECT_EQ(ps::Segmenter().segment(step.image).frame().size(), 424U * 240);
  static_assert(!std::is_invocable_v<decltype([](auto r) -> decltype(std::move(r).plane_of()) {
                                       return std::move(r).plane_of();
                                     }),
                                     ps::Result>);
}

TEST(Library, GravityOfAnyLengthIsADirection) {
  Step step;
  step.image.gravity = ps::Vec3{0, 1e200, 0};
  EXPECT_EQ(ps::segment(step.image).gravity().direction, (ps::Vec3{0, 1, 0}));
  EXPECT_EQ(ps::segment(step.image).planes().size(), 3U);
}

TEST(Library, OptionsSetByNameDoNotDependOnTheOrder) {
  const auto cropped = [](bool before) {
    ps::Options options;
    if (before) options.set("range_for_clouds", "off");
    options.set("max_range_m", 1);
    if (!before) options.set("range_for_clouds", "off");
    return options.get("range_for_clouds");
  };
  EXPECT_EQ(cropped(true), "off");
  EXPECT_EQ(cropped(false), "off");
  EXPECT_EQ(ps::Options().set("max_range_m", 1).get("range_for_clouds"), "on");
}

TEST(Library, ARendererCanBeDestroyedOnAnotherThread) {
  auto renderer = std::make_unique<ps::Renderer>();
  std::thread([&] { renderer.reset(); }).join();
  EXPECT_FALSE(renderer);
}

TEST(Library, FramesOfARecordingCanBeStoredInAVector) {
  const ps::Recording recording(PLANESCOPE_SAMPLE);
  const std::vector<ps::Frame> frames(recording.begin(), recording.end());
  ASSERT_EQ(frames.size(), 3U);
  EXPECT_EQ(frames[2].index(), 2);
}

TEST(Library, ProfilesAndOptionsMatchTheProgram) {
  EXPECT_EQ(ps::Options().get("profile"), "refined");
  EXPECT_EQ(ps::Options("paper").get("profile"), "paper");
  ps::Options options;
  options.set("theta_n_in", 20).set("classifier", "pca");
  EXPECT_EQ(options.get("theta_n_in"), "20");
  const ps::Options copy = options;
  options.set("theta_n_in", 21);
  EXPECT_EQ(copy.get("theta_n_in"), "20");
  bool has_worth = false;
  for (const ps::OptionInfo& info : ps::Options::all())
    has_worth |= info.section == "objective" && info.name == "worth_px";
  EXPECT_TRUE(has_worth);
  EXPECT_EQ(error_of([] { ps::Options().set("r1_merge_by_distance", "on"); }),
            "option r1_merge_by_distance was removed in 0.2; see merge_cost");
}

TEST(Library, ACloudFarFromItsOriginHasTheSamePlanes) {
  std::vector<double> xyz;
  for (int i = 0; i < 100; ++i)
    for (int k = 0; k < 100; ++k) xyz.insert(xyz.end(), {5e5 + 0.01 * i, 4e6 + 0.01 * k, 321.5});
  ps::PointCloud cloud;
  cloud.xyz = xyz.data();
  cloud.size = xyz.size() / 3;
  const ps::Result result = ps::segment(cloud);
  ASSERT_EQ(result.planes().size(), 1U);
  EXPECT_NEAR(result.planes()[0].centroid[0], 5e5 + 0.495, 1e-3);
  EXPECT_NEAR(result.planes()[0].offset_m, 321.5, 1e-3);
  EXPECT_NEAR(result.points()[9999][1], 4e6 + 0.99, 1e-4);
}

TEST(Library, EveryStepOfATraceIsDescribedAndTheLastIsTheResult) {
  const ps::Recording recording(PLANESCOPE_SAMPLE);
  const ps::Frame frame = recording[0];
  const ps::Segmenter segmenter;
  const ps::Trace trace = segmenter.trace(frame);
  const ps::Result result = segmenter.segment(frame);
  EXPECT_EQ(trace.result().json(), result.json());
  ASSERT_GT(trace.steps(), 100);
  for (int step = 1; step <= trace.steps(); ++step) EXPECT_FALSE(trace.describe(step).empty());
  EXPECT_EQ(error_of([&] { trace.describe(0); }),
            "step 0 is out of range; expected 1 to " + std::to_string(trace.steps()));

  const std::vector<ps::Node> nodes = trace.nodes();
  int found = 0;
  for (const ps::Event& event : trace.events()) {
    if (event.type == ps::EventType::decide) {
      EXPECT_EQ(nodes[static_cast<std::size_t>(event.node)].node_case, event.node_case);
    }
    found += event.type == ps::EventType::found;
  }
  std::vector<bool> has_id(result.planes().size() + 1, false);
  for (int plane = 0; plane < found; ++plane)
    has_id[static_cast<std::size_t>(trace.id_of(plane))] = true;
  for (std::size_t id = 1; id < has_id.size(); ++id) EXPECT_TRUE(has_id[id]) << id;

  const std::vector<std::int32_t> none = trace.plane_of(0);
  EXPECT_EQ(none, std::vector<std::int32_t>(frame.size(), -1));
  const std::vector<std::int32_t> last = trace.plane_of(trace.steps());
  EXPECT_EQ(last[320 * 640 + 320], trace.plane_of(trace.steps(), 320 * 640 + 320));
}

TEST(Library, ThreadsMayShareASegmenterAndARecording) {
  const ps::Recording recording(PLANESCOPE_SAMPLE);
  const ps::Segmenter segmenter;
  std::vector<std::string> alone, together(3);
  for (const ps::Frame& frame : recording) alone.push_back(segmenter.segment(frame).json());
  std::vector<std::thread> threads;
  for (int i = 0; i < 3; ++i)
    threads.emplace_back(
        [&, i] { together[static_cast<std::size_t>(i)] = segmenter.segment(recording[i]).json(); });
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(alone, together);
}

TEST(Library, DrawsPlanesAndSteps) {
  const ps::Frame frame = ps::Recording(PLANESCOPE_SAMPLE)[0];
  const ps::Trace trace = ps::Segmenter().trace(frame);
  const ps::Result result = trace.result();
  ps::Renderer renderer;
  const auto colors = [](const ps::Image& image) {
    std::vector<bool> seen(1 << 12);
    int count = 0;
    for (std::size_t i = 0; i < image.rgb.size(); i += 3) {
      const std::size_t key =
          (image.rgb[i] >> 4) << 8 | (image.rgb[i + 1] >> 4) << 4 | (image.rgb[i + 2] >> 4);
      count += !seen[key];
      seen[key] = true;
    }
    return count;
  };
  std::vector<ps::Image> images;
  for (const ps::Picture picture :
       {ps::Picture::planes, ps::Picture::labels, ps::Picture::cases, ps::Picture::leftovers,
        ps::Picture::overlay, ps::Picture::depth})
    images.push_back(renderer.draw(result, picture, 400, 300));
  images.push_back(renderer.draw(trace, trace.steps() / 2, 400, 300, ps::Theme::dark));
  for (std::size_t i = 0; i < images.size(); ++i) {
    EXPECT_GT(colors(images[i]), 30) << i;
    for (std::size_t k = 0; k < i; ++k) EXPECT_NE(images[i].rgb, images[k].rgb) << i << " " << k;
  }
  EXPECT_EQ(images[0].width, 400);
  EXPECT_EQ(images[0].rgb.size(), 400U * 300 * 3);
  EXPECT_EQ(error_of([&] { renderer.draw(result, ps::Picture::planes, 0, 3); }),
            "picture: 0x3 pixels; expected 1 to 16384 in each direction");
}

}  // namespace
