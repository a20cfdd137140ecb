#include "core/planes/foot/convex_pieces.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <set>

#include "core/model/plane.hpp"

namespace planescope::planes {
namespace {

constexpr double kTouch_m = 1e-7;  // nearer than this is the same place

double cross(const Vec2d& a, const Vec2d& b) { return a.x() * b.y() - a.y() * b.x(); }

/// What is on its left.
struct HalfPlane {
  Vec2d from, along;
  double inside(const Vec2d& p) const { return cross(along, p - from); }
};

PolygonRing cut(const PolygonRing& convex, const HalfPlane& half) {
  PolygonRing kept;
  for (std::size_t i = 0; i < convex.size(); ++i) {
    const Vec2d &a = convex[i], &b = convex[(i + 1) % convex.size()];
    const double at_a = half.inside(a), at_b = half.inside(b);
    if (at_a >= 0) kept.push_back(a);
    if ((at_a > 0 && at_b < 0) || (at_a < 0 && at_b > 0))
      kept.push_back(a + (b - a) * (at_a / (at_a - at_b)));
  }
  return kept;
}

struct Piece {
  PolygonRing ring;
  double area_m2 = 0;
  std::set<int> neighbours;
  bool gone = false;
};

/// A way to make one convex piece of two.
struct Join {
  int a = 0, b = 0;
  PolygonRing ring;
  double area_m2 = 0, loss_m2 = 0, shared_m = 0;
};

/// Where edge a of one piece and edge b of another run along each other.
struct Shared {
  std::size_t a = 0, b = 0;
  Vec2d begin, end;  // as the first piece goes
  double length_m = 0;
};

std::optional<Shared> shared_edge(const PolygonRing& a, const PolygonRing& b) {
  std::optional<Shared> longest;
  for (std::size_t i = 0; i < a.size(); ++i) {
    const Vec2d& a0 = a[i];
    const Vec2d along = a[(i + 1) % a.size()] - a0;
    const double length = along.norm();
    if (length < kTouch_m) continue;
    const Vec2d unit = along / length;
    for (std::size_t j = 0; j < b.size(); ++j) {
      const Vec2d to_begin = b[(j + 1) % b.size()] - a0, to_end = b[j] - a0;
      if (std::abs(cross(unit, to_begin)) > kTouch_m || std::abs(cross(unit, to_end)) > kTouch_m)
        continue;
      const double begin = std::max(0.0, unit.dot(to_begin));
      const double end = std::min(length, unit.dot(to_end));
      if (end - begin > std::max(kTouch_m, longest ? longest->length_m : 0))
        longest = Shared{i, j, a0 + begin * unit, a0 + end * unit, end - begin};
    }
  }
  return longest;
}

/// The lines along which the corner at `at` may be made convex, where the boundary of two joined
/// pieces goes over from edge `i` of `from` to the end of edge `j` of `to`. None: it is convex.
std::vector<HalfPlane> cuts_at(
    const Vec2d& at, const PolygonRing& from, std::size_t i, const PolygonRing& to, std::size_t j) {
  const auto corner = [](const PolygonRing& ring, std::size_t k) { return ring[k % ring.size()]; };
  const bool whole_from = (corner(from, i) - at).norm() < kTouch_m;
  const Vec2d before = whole_from ? corner(from, i + from.size() - 1) : corner(from, i);
  const bool whole_to = (corner(to, j + 1) - at).norm() < kTouch_m;
  const Vec2d after = whole_to ? corner(to, j + 2) : corner(to, j + 1);
  const Vec2d in = at - before, out = after - at;
  if (cross(in, out) >= 0) return {};
  return {{at, in}, {at, out}};
}

/// The largest convex piece that is in both and keeps to lines through their common corners.
std::optional<Join> join_of(const std::vector<Piece>& pieces, int a, int b) {
  const PolygonRing &first = pieces[a].ring, &second = pieces[b].ring;
  const std::optional<Shared> shared = shared_edge(first, second);
  if (!shared) return std::nullopt;
  std::vector<HalfPlane> begins = cuts_at(shared->begin, first, shared->a, second, shared->b);
  std::vector<HalfPlane> ends = cuts_at(shared->end, second, shared->b, first, shared->a);
  const HalfPlane everything{Vec2d::Zero(), Vec2d::Zero()};
  if (begins.empty()) begins = {everything};
  if (ends.empty()) ends = {everything};
  const double both_m2 = pieces[a].area_m2 + pieces[b].area_m2;
  std::optional<Join> best;
  for (const HalfPlane& begin : begins)
    for (const HalfPlane& end : ends) {
      const PolygonRing of_a = cut(cut(first, begin), end), of_b = cut(cut(second, begin), end);
      std::vector<Vec2d> corners = of_a;
      corners.insert(corners.end(), of_b.begin(), of_b.end());
      Join join{a, b, convex_hull(std::move(corners)), 0, 0, shared->length_m};
      join.area_m2 = polygon_area(join.ring);
      const double kept_m2 = polygon_area(of_a) + polygon_area(of_b);
      if (join.ring.size() < 3 || join.area_m2 > kept_m2 + 1e-9 * both_m2) continue;  // not convex
      join.loss_m2 = std::max(0.0, both_m2 - join.area_m2);
      if (join.loss_m2 < 1e-9 * both_m2) join.loss_m2 = 0;
      if (!best || join.loss_m2 < best->loss_m2) best = std::move(join);
    }
  return best;
}

std::vector<Piece> pieces_of(const std::vector<Triangle>& triangles) {
  using Edge = std::array<double, 4>;
  std::map<Edge, int> by_edge;
  std::vector<Piece> pieces;
  for (const Triangle& triangle : triangles) {
    Piece piece{{triangle.begin(), triangle.end()}, 0, {}, false};
    piece.area_m2 = polygon_area(piece.ring);
    const int number = static_cast<int>(pieces.size());
    for (int i = 0; i < 3; ++i) {
      const Vec2d &a = triangle[i], &b = triangle[(i + 1) % 3];
      if (const auto other = by_edge.find({b.x(), b.y(), a.x(), a.y()}); other != by_edge.end()) {
        piece.neighbours.insert(other->second);
        pieces[other->second].neighbours.insert(number);
      }
      by_edge[{a.x(), a.y(), b.x(), b.y()}] = number;
    }
    pieces.push_back(std::move(piece));
  }
  return pieces;
}

class Joining {
 public:
  explicit Joining(std::vector<Piece> pieces) : pieces_(std::move(pieces)) {
    for (int a = 0; a < static_cast<int>(pieces_.size()); ++a)
      for (const int b : pieces_[a].neighbours)
        if (a < b) consider(a, b);
  }

  /// Fewer pieces, as long as that costs no more than `budget_m2` in all.
  std::vector<PolygonRing> spend(double budget_m2) {
    while (true) {
      const auto join = std::ranges::min_element(joins_, [](const Join& a, const Join& b) {
        return a.loss_m2 != b.loss_m2 ? a.loss_m2 < b.loss_m2 : a.shared_m > b.shared_m;
      });
      const int sliver = smallest();
      const bool can_join = join != joins_.end();
      const bool drop = sliver >= 0 && (!can_join || pieces_[sliver].area_m2 < join->loss_m2);
      if (!drop && !can_join) break;
      const double cost_m2 = drop ? pieces_[sliver].area_m2 : join->loss_m2;
      if (cost_m2 > budget_m2) break;
      budget_m2 -= cost_m2;
      if (drop)
        remove(sliver);
      else
        make(Join(*join));
    }
    std::vector<PolygonRing> rings;
    for (Piece& piece : pieces_)
      if (!piece.gone) rings.push_back(std::move(piece.ring));
    std::ranges::stable_sort(rings, std::ranges::greater{},
                             [](const PolygonRing& ring) { return polygon_area(ring); });
    return rings;
  }

 private:
  void consider(int a, int b) {
    if (std::optional<Join> join = join_of(pieces_, a, b)) joins_.push_back(std::move(*join));
  }
  void remove(int piece) {
    pieces_[piece].gone = true;
    for (const int other : pieces_[piece].neighbours) pieces_[other].neighbours.erase(piece);
    std::erase_if(joins_, [&](const Join& join) { return join.a == piece || join.b == piece; });
  }
  void make(const Join& join) {
    Piece made{join.ring, join.area_m2, pieces_[join.a].neighbours, false};
    made.neighbours.insert(pieces_[join.b].neighbours.begin(), pieces_[join.b].neighbours.end());
    made.neighbours.erase(join.a);
    made.neighbours.erase(join.b);
    remove(join.a);
    remove(join.b);
    const int number = static_cast<int>(pieces_.size());
    pieces_.push_back(std::move(made));
    for (const int other : pieces_[number].neighbours) {
      pieces_[other].neighbours.insert(number);
      consider(other, number);
    }
  }
  int smallest() const {
    int found = -1;
    for (int i = 0; i < static_cast<int>(pieces_.size()); ++i)
      if (!pieces_[i].gone && (found < 0 || pieces_[i].area_m2 < pieces_[found].area_m2)) found = i;
    return found;
  }

  std::vector<Piece> pieces_;
  std::vector<Join> joins_;
};

}  // namespace

std::vector<PolygonRing> convex_pieces(const Polygons& polygons, double least_share) {
  if (polygons.empty()) return {};
  Joining joining(pieces_of(triangulated(polygons)));
  return joining.spend((1 - least_share) * area(polygons));
}

}  // namespace planescope::planes
