// Joins regions, lowest cost first.

#include <algorithm>
#include <queue>

#include "core/planes/depth/regions.hpp"
#include "core/planes/segment/roots.hpp"

namespace planescope::planes {
namespace {

constexpr double kLargePart = 1500;  // px: joins of smaller parts do not make a plane doubtful

using Neighbors = std::vector<std::pair<std::int32_t, int>>;

struct Join {
  double cost = 0;
  std::int32_t a = 0, b = 0, version_a = 0, version_b = 0;
  /// Ties go to the regions founded first, which is by place in the image.
  bool operator<(const Join& o) const {
    return cost != o.cost ? cost > o.cost : a != o.a ? a > o.a : b > o.b;
  }
};

Neighbors::iterator place_of(Neighbors& near, std::int32_t region) {
  return std::ranges::lower_bound(near, region, {}, &Neighbors::value_type::first);
}
void erase(Neighbors& near, std::int32_t region) {
  const auto at = place_of(near, region);
  if (at != near.end() && at->first == region) near.erase(at);
}
void set(Neighbors& near, std::int32_t region, int border) {
  const auto at = place_of(near, region);
  if (at != near.end() && at->first == region)
    at->second = border;
  else
    near.insert(at, {region, border});
}

/// Neighbors of either but the two themselves; borders with a third add.
void unite(const Neighbors& a,
           const Neighbors& b,
           std::int32_t self,
           std::int32_t other,
           Neighbors& both) {
  both.clear();
  auto i = a.begin();
  auto j = b.begin();
  while (i != a.end() || j != b.end()) {
    std::pair<std::int32_t, int> next;
    if (j == b.end() || (i != a.end() && i->first < j->first)) {
      next = *i++;
    } else if (i == a.end() || j->first < i->first) {
      next = *j++;
    } else {
      next = {i->first, i->second + j->second};
      ++i, ++j;
    }
    if (next.first != self && next.first != other) both.push_back(next);
  }
}

class Merger {
 public:
  explicit Merger(DepthSegmentation& s) : s_(s), roots_(s.regions.size()) {
    for (std::int32_t a = 0; a < static_cast<std::int32_t>(s.regions.size()); ++a)
      if (s.regions[a].alive)
        for (const auto& [b, border] : s.regions[a].near)
          if (b > a) consider(a, b);
  }

  void run() {
    while (!queue_.empty()) {
      const Join join = queue_.top();
      queue_.pop();
      const DepthRegion &a = s_.regions[join.a], &b = s_.regions[join.b];
      if (!a.alive || !b.alive || a.version != join.version_a || b.version != join.version_b)
        continue;
      if (a.moments.n >= b.moments.n)
        this->join(join.b, join.a, join.cost);
      else
        this->join(join.a, join.b, join.cost);
    }
    roots_.apply_to(s_.region_of);
  }

 private:
  void consider(std::int32_t a, std::int32_t b) {
    const double cost = s_.join_cost(a, b);
    if (cost < s_.options.merge_cost)
      queue_.push({cost, a, b, s_.regions[a].version, s_.regions[b].version});
  }

  void join(std::int32_t from, std::int32_t into, double cost) {
    join_regions(s_, Stage::join, from, into, cost);
    roots_.join_into(from, into);
    DepthRegion &gone = s_.regions[from], &grown = s_.regions[into];
    unite(grown.near, gone.near, into, from, both_);
    for (const auto& [third, border] : gone.near)
      if (third != into) erase(s_.regions[third].near, from);
    grown.near.swap(both_);
    gone.near.clear();
    for (const auto& [third, border] : grown.near) set(s_.regions[third].near, into, border);
    for (const auto& [third, border] : grown.near) consider(into, third);
  }

  DepthSegmentation& s_;
  Roots roots_;
  std::priority_queue<Join> queue_;
  Neighbors both_;
};

/// Border lengths of pairs of regions: open addressing, as the same pairs come again and again.
class BorderTable {
 public:
  explicit BorderTable(std::size_t regions) {
    std::size_t size = 64;
    while (size < 8 * regions) size *= 2;
    slots_.resize(size);
  }
  void add(std::int32_t a, std::int32_t b) {
    if (a > b) std::swap(a, b);
    const std::uint64_t key =
        (static_cast<std::uint64_t>(a) << 32 | static_cast<std::uint32_t>(b)) + 1;
    for (std::size_t at = (key * 0x9e3779b97f4a7c15u) >> 20 & (slots_.size() - 1);;
         at = (at + 1) & (slots_.size() - 1)) {
      if (slots_[at].key == key) {
        ++slots_[at].count;
        return;
      }
      if (slots_[at].key != 0) continue;
      slots_[at] = {key, 1};
      if (2 * ++used_ > slots_.size()) grow();
      return;
    }
  }
  template <typename Visit>
  void each(Visit visit) const {
    for (const Slot& slot : slots_)
      if (slot.key != 0)
        visit(static_cast<std::int32_t>((slot.key - 1) >> 32),
              static_cast<std::int32_t>((slot.key - 1) & 0xffffffff), slot.count);
  }

 private:
  struct Slot {
    std::uint64_t key = 0;
    int count = 0;
  };
  void grow() {
    std::vector<Slot> old(2 * slots_.size());
    old.swap(slots_);
    for (const Slot& slot : old) {
      if (slot.key == 0) continue;
      std::size_t at = (slot.key * 0x9e3779b97f4a7c15u) >> 20 & (slots_.size() - 1);
      while (slots_[at].key != 0) at = (at + 1) & (slots_.size() - 1);
      slots_[at] = slot;
    }
  }
  std::vector<Slot> slots_;
  std::size_t used_ = 0;
};

}  // namespace

void find_neighbors(DepthSegmentation& s, int least, int gap, double step) {
  BorderTable borders(s.regions.size());
  const int width = s.image.width, height = s.image.height;
  const std::vector<std::int32_t>& region = s.region_of;
  const std::vector<float>& rho = s.image.rho;
  for (int d = 1; d <= gap + 1; ++d)
    for (int y = 0; y < height; ++y) {
      const std::size_t row = static_cast<std::size_t>(y) * width;
      const auto look = [&](std::size_t i, std::size_t o) {
        const std::int32_t a = region[i], b = region[o];
        if (a != b && a >= 0 && b >= 0 && std::abs(rho[o] - rho[i]) < step) borders.add(a, b);
      };
      // Most of an image lies inside of regions: whole runs are passed over at once.
      const auto look_along = [&](std::size_t from, std::size_t to, int count) {
        constexpr int kRun = 16;
        int x = 0;
        for (; x + kRun <= count; x += kRun) {
          std::int32_t differs = 0;
          for (int k = 0; k < kRun; ++k) differs |= region[from + x + k] ^ region[to + x + k];
          if (differs == 0) continue;
          for (int k = 0; k < kRun; ++k) look(from + x + k, to + x + k);
        }
        for (; x < count; ++x) look(from + x, to + x);
      };
      look_along(row, row + d, width - d);
      if (y + d < height) look_along(row, row + static_cast<std::size_t>(d) * width, width);
    }
  for (DepthRegion& r : s.regions) r.near.clear();
  borders.each([&](std::int32_t a, std::int32_t b, int count) {
    if (count < least) return;
    s.regions[a].near.emplace_back(b, count);
    s.regions[b].near.emplace_back(a, count);
  });
  for (DepthRegion& r : s.regions) std::ranges::sort(r.near);
}

void join_regions(
    DepthSegmentation& s, Stage stage, std::int32_t from, std::int32_t into, double cost) {
  DepthRegion &gone = s.regions[from], &grown = s.regions[into];
  const double smaller = std::min(gone.moments.n, grown.moments.n);
  grown.dearest_join =
      std::max({grown.dearest_join, gone.dearest_join, smaller >= kLargePart ? cost : 0});
  log_join(s, stage, from, into, cost);
  grown.moments += gone.moments;
  grown.plane = grown.moments.fit();
  ++grown.version;
  gone.alive = false;
  ++s.counts.merges;
}

void merge_regions(DepthSegmentation& s) { Merger(s).run(); }

}  // namespace planescope::planes
