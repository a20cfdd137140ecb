// Joins regions, lowest cost first.

#include <algorithm>
#include <bit>
#include <cmath>
#include <iterator>

#include "core/model/disjoint_sets.hpp"
#include "core/planes/depth/regions.hpp"

namespace planescope::planes {
namespace {

constexpr double kDear = 0.5;  // share of merge_cost; cheaper joins are unambiguous

using Neighbors = std::vector<DepthNeighbor>;

Neighbors::iterator place_of(Neighbors& near, std::int32_t region) {
  return std::ranges::lower_bound(near, region, {}, &DepthNeighbor::region);
}
void erase(Neighbors& near, std::int32_t region) {
  const auto at = place_of(near, region);
  if (at != near.end() && at->region == region) near.erase(at);
}
void set(Neighbors& near, DepthNeighbor neighbor) {
  const auto at = place_of(near, neighbor.region);
  if (at != near.end() && at->region == neighbor.region)
    *at = neighbor;
  else
    near.insert(at, neighbor);
}

/// Orders by cost, then by region.
bool cheaper(const DepthNeighbor& a, const DepthNeighbor& b) {
  return a.cost != b.cost ? a.cost < b.cost : a.region < b.region;
}

/// The best join of each region with a region of higher index, in a winner tree over all regions.
/// Ties go to the region created first, and thus to image order.
class BestJoins {
 public:
  explicit BestJoins(std::size_t regions)
      : leaves_(std::bit_ceil(std::max<std::size_t>(2, regions))),
        best_(leaves_),
        winner_(leaves_, 0) {
    for (std::size_t node = leaves_ - 1; node > 0; --node) winner_[node] = winner(2 * node);
  }

  const DepthNeighbor& of(std::int32_t region) const { return best_[region]; }
  void set(std::int32_t region, const DepthNeighbor& join) {
    best_[region] = join;
    const auto leaf = static_cast<std::size_t>(region);
    for (std::size_t node = (leaves_ + leaf) / 2; node > 0; node /= 2) {
      const std::int32_t a = winner(2 * node), b = winner(2 * node + 1);
      const std::int32_t better = best_[b].cost < best_[a].cost ? b : a;
      if (better == winner_[node] && better != region) break;
      winner_[node] = better;
    }
  }
  /// The region with the best join; of(it).cost is infinite if no join remains.
  std::int32_t best() const { return winner_[1]; }

 private:
  std::int32_t winner(std::size_t node) const {
    return node < leaves_ ? winner_[node] : static_cast<std::int32_t>(node - leaves_);
  }

  std::size_t leaves_;
  std::vector<DepthNeighbor> best_;   // per region
  std::vector<std::int32_t> winner_;  // per inner node; 1 is the root
};

class Merger {
 public:
  explicit Merger(DepthSegmentation& s) : s_(s), best_(s.regions.size()), roots_(s.regions.size()) {
    for (std::int32_t a = 0; a < static_cast<std::int32_t>(s.regions.size()); ++a) {
      if (!s.regions[a].alive) continue;
      for (DepthNeighbor& near : s.regions[a].near)
        if (near.region > a) near.cost = s.join_cost(a, near.region);
      find_best(a);
    }
  }

  void run() {
    bool joined = false;
    while (true) {
      const std::int32_t a = best_.best();
      const auto [b, cost] = best_.of(a);
      if (!(cost < s_.options.merge_cost)) break;
      const bool first = s_.regions[a].moments.n >= s_.regions[b].moments.n;
      join(first ? b : a, first ? a : b, cost);
      joined = true;
    }
    if (joined) roots_.apply_to(s_.region_of);
  }

 private:
  void find_best(std::int32_t region) {
    DepthNeighbor best;
    const Neighbors& near = s_.regions[region].near;
    for (auto at = near.rbegin(); at != near.rend() && at->region > region; ++at)
      best = std::min(best, *at, cheaper);
    best_.set(region, best);
  }

  void join(std::int32_t from, std::int32_t into, double cost) {
    join_regions(s_, Stage::join, from, into, cost);
    roots_.join_into(from, into);
    best_.set(from, {});
    Neighbors &gone = s_.regions[from].near, &grown = s_.regions[into].near;
    both_.clear();
    std::ranges::set_union(grown, gone, std::back_inserter(both_), {}, &DepthNeighbor::region,
                           &DepthNeighbor::region);
    std::erase_if(both_, [&](const DepthNeighbor& near) {
      return near.region == from || near.region == into;
    });
    for (const DepthNeighbor& near : gone)
      if (near.region != into) erase(s_.regions[near.region].near, from);
    grown.swap(both_);
    gone.clear();
    for (DepthNeighbor& near : grown) {
      const std::int32_t third = near.region;
      near.cost = s_.join_cost(into, third);
      set(s_.regions[third].near, {into, near.cost});
      const std::int32_t before = best_.of(third).region;
      if (before == from || before == into)
        find_best(third);
      else if (third < into && cheaper({into, near.cost}, best_.of(third)))
        best_.set(third, {into, near.cost});
    }
    find_best(into);
  }

  DepthSegmentation& s_;
  BestJoins best_;
  Roots roots_;
  Neighbors both_;
};

/// Border lengths of pairs of regions. Open addressing with a cached slot, because the same pair
/// occurs many times in a row.
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
    if (slots_[last_].key == key) {  // same border as before
      ++slots_[last_].count;
      return;
    }
    for (std::size_t at = (key * 0x9e3779b97f4a7c15u) >> 20 & (slots_.size() - 1);;
         at = (at + 1) & (slots_.size() - 1)) {
      if (slots_[at].key != key && slots_[at].key != 0) continue;
      used_ += slots_[at].key == 0;
      slots_[at] = {key, slots_[at].count + 1};
      last_ = at;
      if (2 * used_ > slots_.size()) grow();
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
  std::size_t used_ = 0, last_ = 0;
};

}  // namespace

void find_neighbors(DepthSegmentation& s, int least, int gap, double step) {
  BorderTable borders(s.regions.size());
  const int width = s.image.width, height = s.image.height;
  const std::vector<std::int32_t>& region = s.region_of;
  const std::vector<float>& rho = s.image.rho;
  const auto look = [&](std::size_t i, std::size_t o) {
    const std::int32_t a = region[i], b = region[o];
    if (a != b && a >= 0 && b >= 0 && std::abs(rho[o] - rho[i]) < step) borders.add(a, b);
  };
  for (int y = 0; y < height; ++y)
    for (int d = 1; d <= gap + 1; ++d) {
      const std::size_t row = static_cast<std::size_t>(y) * width;
      const std::size_t below = row + static_cast<std::size_t>(d) * width;
      const bool has_below = y + d < height;
      // Most pixels are inside a region: skip whole runs at once.
      constexpr int kRun = 16;
      int x = 0;
      for (; has_below && x + kRun + d <= width; x += kRun) {
        std::int32_t differs = 0;
        for (int k = 0; k < kRun; ++k) {
          const std::int32_t here = region[row + x + k];
          differs |= (region[row + x + k + d] ^ here) | (region[below + x + k] ^ here);
        }
        if (differs == 0) continue;
        for (int k = 0; k < kRun; ++k) {
          look(row + x + k, row + x + k + d);
          look(row + x + k, below + x + k);
        }
      }
      for (; x < width; ++x) {
        if (x + d < width) look(row + x, row + x + d);
        if (has_below) look(row + x, below + x);
      }
    }
  for (DepthRegion& r : s.regions) r.near.clear();
  borders.each([&](std::int32_t a, std::int32_t b, int count) {
    if (count < least) return;
    s.regions[a].near.push_back({b});
    s.regions[b].near.push_back({a});
  });
  for (DepthRegion& r : s.regions) std::ranges::sort(r.near, {}, &DepthNeighbor::region);
}

void join_regions(
    DepthSegmentation& s, Stage stage, std::int32_t from, std::int32_t into, double cost) {
  DepthRegion &gone = s.regions[from], &grown = s.regions[into];
  std::ranges::copy(gone.dear_joins, std::back_inserter(grown.dear_joins));
  if (cost > kDear * s.options.merge_cost)
    grown.dear_joins.push_back({cost, std::min(gone.moments.n, grown.moments.n)});
  log_join(s, stage, from, into, cost);
  grown.known = std::max(grown.known, gone.known);
  grown.moments += gone.moments;
  grown.plane = grown.moments.fit();
  gone.alive = false;
  ++s.counts.merges;
}

void merge_regions(DepthSegmentation& s) { Merger(s).run(); }

}  // namespace planescope::planes
