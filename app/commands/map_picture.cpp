// Draws a map from above: planes, the camera path, plane names with heights, and a scale.

#include "app/commands/map_picture.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <optional>

#include "core/world/files/map_files.hpp"
#include "render/paint.hpp"
#include "render/palette.hpp"
#include "render/plane_colors.hpp"

namespace planescope::app {
namespace {

using world::Track;

constexpr render::Rgba kGround = {250, 250, 251, 255};
constexpr render::Rgba kInk = {28, 32, 38, 255};
constexpr render::Rgba kWay = {28, 32, 38, 200};
constexpr double kMargin_m = 0.3, kMost_px = 1600, kMost_px_per_m = 150;
constexpr double kText_px = 15;

bool is_upright(const Track& track) { return std::abs(track.fit.normal.z()) < 0.5; }

/// World to picture coordinates.
struct Sheet {
  Vec2d low = Vec2d::Constant(std::numeric_limits<double>::infinity());
  Vec2d high = -low;
  double px_per_m = 0;

  void add(const Vec3d& p) {
    low = low.cwiseMin(p.head<2>());
    high = high.cwiseMax(p.head<2>());
  }
  bool empty() const { return !(low.x() <= high.x()); }
  void settle() {
    low -= Vec2d::Constant(kMargin_m);
    high += Vec2d::Constant(kMargin_m);
    px_per_m = std::min(kMost_px_per_m, kMost_px / (high - low).maxCoeff());
  }
  int width() const { return static_cast<int>(std::ceil(px_per_m * (high.x() - low.x()))); }
  int height() const { return static_cast<int>(std::ceil(px_per_m * (high.y() - low.y()))); }
  Vec2d at(const Vec3d& p) const {
    return {px_per_m * (p.x() - low.x()), px_per_m * (high.y() - p.y())};
  }
};

/// Draws the cells of a plane as squares; higher cells cover lower ones.
class CellPainter {
 public:
  CellPainter(Image8& image, const Sheet& sheet, std::vector<int> colors)
      : image_(image),
        sheet_(sheet),
        colors_(std::move(colors)),
        top_(static_cast<std::size_t>(image.width) * image.height,
             -std::numeric_limits<double>::infinity()),
        track_of_(top_.size(), 0) {}

  /// Visible track by pixel; 0: none.
  const std::vector<int>& track_of() const { return track_of_; }

  void add(const Track& track) {
    const bool gone = track.state == world::TrackState::gone;
    const render::Rgba color = render::plane_color(colors_[static_cast<std::size_t>(track.id) - 1]);
    const double side = sheet_.px_per_m * track.cells.cell_m();
    const int size = std::max(1, static_cast<int>(std::ceil(side)));
    for (const Vec2d& place : track.places()) {
      const Vec3d p = track.on_plane(place);
      const Vec2d at = sheet_.at(p);
      const auto x0 = static_cast<int>(std::floor(at.x() - side / 2)),
                 y0 = static_cast<int>(std::floor(at.y() - side / 2));
      for (int y = y0; y < y0 + size; ++y)
        for (int x = x0; x < x0 + size; ++x) paint(x, y, p.z(), color, gone ? -track.id : track.id);
    }
  }

 private:
  /// `track` is negative if its state is `gone`.
  void paint(int x, int y, double z, render::Rgba color, int track) {
    if (x < 0 || y < 0 || x >= image_.width || y >= image_.height) return;
    const std::size_t i = static_cast<std::size_t>(y) * image_.width + x;
    if (z < top_[i] || (track < 0 && !render::on_hatch(x, y, 5))) return;
    top_[i] = z;
    track_of_[i] = std::abs(track);
    render::fill_rect(image_, x, y, 1, 1, color);
  }

  Image8& image_;
  const Sheet& sheet_;
  std::vector<int> colors_;  // by track
  std::vector<double> top_;
  std::vector<int> track_of_;
};

/// Distance from each pixel to the nearest pixel of another track or the border [px, chessboard].
std::vector<int> depths_in_tracks(const std::vector<int>& track_of, int width, int height) {
  std::vector<int> depth(track_of.size());
  const auto relax = [&](int x, int y, std::initializer_list<std::pair<int, int>> before) {
    const auto index = [&](int px, int py) { return static_cast<std::size_t>(py) * width + px; };
    int& own = depth[index(x, y)];
    for (const auto& [dx, dy] : before) {
      const int px = x + dx, py = y + dy;
      const bool inside = px >= 0 && py >= 0 && px < width && py < height &&
                          track_of[index(px, py)] == track_of[index(x, y)];
      own = std::min(own, inside ? depth[index(px, py)] + 1 : 1);
    }
  };
  std::ranges::fill(depth, width + height);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) relax(x, y, {{-1, 0}, {-1, -1}, {0, -1}, {1, -1}});
  for (int y = height - 1; y >= 0; --y)
    for (int x = width - 1; x >= 0; --x) relax(x, y, {{1, 0}, {1, 1}, {0, 1}, {-1, 1}});
  return depth;
}

bool is_on_way(const world::FrameOfTracks& frame, int segment) {
  return frame.is_in_map() && frame.segment == segment;
}

void draw_way(const world::WorldMap& map, int segment, const Sheet& sheet, Image8& image) {
  const world::FrameOfTracks* before = nullptr;
  for (const world::FrameOfTracks& frame : map.tracker.frames()) {
    if (!is_on_way(frame, segment)) continue;
    const Vec2d to = sheet.at(frame.T_world_camera.translation());
    const Vec2d from = before ? sheet.at(before->T_world_camera.translation()) : to;
    const int steps = std::max(1, static_cast<int>((to - from).norm()));
    for (int i = 0; i < steps; ++i) {
      const Vec2d at = from + (to - from) * i / steps;
      render::fill_disc(image, at.x(), at.y(), 1.2, kWay);
    }
    if (!before) render::fill_disc(image, to.x(), to.y(), 5, kWay);
    before = &frame;
  }
}

/// Draws plane names, and heights below the names of level planes. Names without enough room are
/// skipped.
class NamePainter {
 public:
  NamePainter(Image8& image, const Sheet& sheet, const std::vector<int>& track_of)
      : image_(image),
        sheet_(sheet),
        depths_(depths_in_tracks(track_of, image.width, image.height)) {
    for (std::size_t i = 0; i < track_of.size(); ++i)
      if (track_of[i] > 0) seen_[track_of[i]].push_back(i);
  }

  void add(const Track& track) {
    std::vector<std::string> lines = {fmt::format("T{}", track.id)};
    const double cm = std::round(100 * track.centroid().z()) + 0.0;  // avoids -0
    if (!is_upright(track)) lines.push_back(fmt::format("{:+.2f} m", cm / 100));
    double width = 0;
    for (const std::string& line : lines)
      width = std::max(width, render::text_width(line, kText_px));
    const Vec2d half(width / 2 + 2, kText_px * static_cast<double>(lines.size()) / 2 + 1);
    const std::optional<Vec2d> center = place_of(track, half);
    if (!center) return;
    const Eigen::AlignedBox2d box(*center - half, *center + half);
    taken_.push_back(box);
    for (std::size_t i = 0; i < lines.size(); ++i) {
      const double left = box.center().x() - render::text_width(lines[i], kText_px) / 2;
      const double line = box.min().y() + kText_px * (static_cast<double>(i) + 0.8);
      for (const int dx : {-1, 1})
        for (const int dy : {-1, 1})
          render::draw_text(image_, left + dx, line + dy, lines[i], kText_px, kGround);
      render::draw_text(image_, left, line, lines[i], kText_px, kInk);
    }
  }

 private:
  /// Returns a position in the visible part of the plane: deep enough inside for the name and,
  /// among those, nearest to its centroid.
  std::optional<Vec2d> place_of(const Track& track, const Vec2d& half) const {
    const Vec2d wanted = sheet_.at(track.centroid());
    const int enough = static_cast<int>(std::ceil(half.maxCoeff()));
    std::optional<Vec2d> best;
    std::pair<int, double> best_score;
    const auto seen = seen_.find(track.id);
    if (seen == seen_.end()) return best;
    for (const std::size_t i : seen->second) {
      const Vec2d at(static_cast<double>(i % image_.width), static_cast<double>(i / image_.width));
      const std::pair score(std::min(depths_[i], enough), -(at - wanted).norm());
      if (best && score <= best_score) continue;
      const Eigen::AlignedBox2d box(at - half, at + half);
      if (std::ranges::any_of(taken_, [&](const auto& other) { return box.intersects(other); }))
        continue;
      best = at;
      best_score = score;
    }
    return best;
  }

  Image8& image_;
  const Sheet& sheet_;
  std::vector<int> depths_;
  std::map<int, std::vector<std::size_t>> seen_;  // visible pixels, by track
  std::vector<Eigen::AlignedBox2d> taken_;
};

void draw_scale(const Sheet& sheet, Image8& image) {
  const double length_m = sheet.px_per_m > 40 ? 1 : sheet.px_per_m > 8 ? 5 : 20;
  const auto length = static_cast<int>(length_m * sheet.px_per_m);
  const int x = 12, y = image.height - 14;
  render::fill_rect(image, x, y, length, 3, kInk);
  render::draw_text(image, x, y - 5, render::length_text(length_m), kText_px, kInk);
}

}  // namespace

std::vector<int> colors_of_tracks(const world::Tracker& tracker) {
  const auto& tracks = tracker.tracks();
  planes::Cloud cloud;
  std::vector<std::int32_t> track_of;
  std::map<int, std::vector<int>> seen_in;  // tracks, by frame
  for (const Track& track : tracks) {
    for (const Vec2d& place : track.places()) {
      cloud.points.push_back(track.on_plane(place).cast<float>());
      track_of.push_back(track.id);
    }
    for (const world::Sighting& sighting : track.sightings)
      if (!sighting.part) seen_in[sighting.frame].push_back(track.id);
  }
  const render::PlaneImage image = render::plane_image(cloud, track_of, tracks.size());
  std::vector<std::vector<int>> touching(tracks.size());  // earlier tracks that each touches
  for (const auto& [a, b] : image.touching) touching[static_cast<std::size_t>(b) - 1].push_back(a);

  std::vector<int> colors(tracks.size(), 0), tracks_of_color(render::kPlaneColors + 1, 0);
  const auto color_of = [&](int id) {
    return static_cast<std::size_t>(colors[static_cast<std::size_t>(id) - 1]);
  };
  for (const Track& track : tracks) {
    if (track.state == world::TrackState::merged) continue;
    struct Use {
      int touching = 0, together = 0, anywhere = 0;
      auto operator<=>(const Use&) const = default;
    };
    std::vector<Use> uses(render::kPlaneColors + 1);
    for (std::size_t color = 1; color < uses.size(); ++color)
      uses[color].anywhere = tracks_of_color[color];
    for (const int id : touching[static_cast<std::size_t>(track.id) - 1])
      ++uses[color_of(id)].touching;
    for (const world::Sighting& sighting : track.sightings)
      for (const int id : seen_in[sighting.frame])
        if (id < track.id) ++uses[color_of(id)].together;
    const auto best = std::min_element(uses.begin() + 1, uses.end()) - uses.begin();
    colors[static_cast<std::size_t>(track.id) - 1] = static_cast<int>(best);
    ++tracks_of_color[static_cast<std::size_t>(best)];
  }
  return colors;
}

Image8 map_from_above(const world::WorldMap& map, int segment) {
  std::vector<const Track*> planes;
  Sheet sheet;
  for (const Track* track : world::planes_of_map(map.tracker)) {
    if (track->segment != segment) continue;
    const std::vector<Vec2d> places = track->places();
    for (const Vec2d& place : places) sheet.add(track->on_plane(place));
    if (!places.empty()) planes.push_back(track);
  }
  if (sheet.empty()) return {};
  for (const world::FrameOfTracks& frame : map.tracker.frames())
    if (is_on_way(frame, segment)) sheet.add(frame.T_world_camera.translation());
  sheet.settle();
  Image8 image(sheet.width(), sheet.height(), 3);
  render::fill_rect(image, 0, 0, image.width, image.height, kGround);
  CellPainter painter(image, sheet, colors_of_tracks(map.tracker));
  for (const Track* track : planes) painter.add(*track);
  draw_way(map, segment, sheet, image);
  NamePainter names(image, sheet, painter.track_of());
  // Largest first; risers after the planes they lead to.
  for (const bool upright : {false, true})
    for (const Track* track : planes)
      if (is_upright(*track) == upright) names.add(*track);
  draw_scale(sheet, image);
  return image;
}

}  // namespace planescope::app
