#include "core/labels/review/spread.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "core/labels/edit/operations.hpp"
#include "core/model/error.hpp"

namespace planescope::labels {
namespace {

/// Whose labels can be carried on.
struct Source {
  SpreadFrame at;
  Pose T_world_camera = Pose::Identity();
};

/// The labels of planes that `labels` does not have yet.
FrameLabels without_those_of(const FrameLabels& all, const FrameLabels& labels) {
  FrameLabels rest = all;
  for (const LabelPlane& plane : labels.planes)
    if (find_plane(rest, plane.id)) rest = without_plane(rest, plane.id);
  return rest;
}

class Spreading {
 public:
  explicit Spreading(const SpreadJob& job) : job_(job) {
    const auto pose = job.T_world_camera(job.from);
    if (!pose) throw Error(fmt::format("frame {} has no pose", job.from));
    first_ = {job.open(job.from), *pose};
    if (first_.at.labels.planes.empty())
      throw Error(fmt::format("frame {} has no planes that could be proposed", job.from));
  }

  std::vector<Proposal> run() {
    for (const int direction : {1, -1}) {
      Source before = first_;
      for (int i = job_.from + direction; i >= 0 && i < job_.frames; i += direction) {
        if (job_.stop.stop_requested()) throw Cancelled();
        if (auto here = propose(before, i)) before = std::move(*here);
        if (job_.progress) job_.progress(++done_, job_.frames - 1);
      }
    }
    std::ranges::sort(proposals_, {}, [](const Proposal& proposal) { return proposal.edit.frame; });
    return std::move(proposals_);
  }

 private:
  /// The frame with what is proposed; nothing where it cannot be labelled.
  std::optional<Source> propose(const Source& before, int frame) {
    const auto pose = job_.T_world_camera(frame);
    if (!pose) return std::nullopt;
    Source here;
    here.T_world_camera = *pose;
    try {
      here.at = job_.open(frame);
    } catch (const Error&) {
      return std::nullopt;  // says why where it is opened
    }
    std::size_t doubtful = 0;
    FrameLabels labels = carry(before, here, before.at.labels, here.at.labels, doubtful);
    const FrameLabels unseen = without_those_of(first_.at.labels, labels);
    if (&before != &first_ && !unseen.planes.empty())
      labels = carry(first_, here, unseen, labels, doubtful);
    Proposal proposal = proposal_of(frame, fmt::format("Propose labels of frame {}", job_.from),
                                    here.at.labels, labels);
    proposal.doubtful = doubtful;
    if (!proposal.edit.empty()) proposals_.push_back(std::move(proposal));
    here.at.labels = std::move(labels);
    return here;
  }

  FrameLabels carry(const Source& from,
                    const Source& to,
                    const FrameLabels& labels,
                    const FrameLabels& existing,
                    std::size_t& doubtful) const {
    CarryOptions options;
    options.T_to_from = to.T_world_camera.inverse() * from.T_world_camera;
    const CarriedLabels carried = carry_labels(from.at.frame, from.at.grid, labels, to.at.frame,
                                               to.at.grid, existing, options, job_.stop);
    for (const CarriedPlane& plane : carried.planes) doubtful += plane.doubtful;
    return carried.labels;
  }

  const SpreadJob& job_;
  Source first_;
  std::vector<Proposal> proposals_;
  int done_ = 0;
};

}  // namespace

Proposal proposal_of(int frame,
                     std::string title,
                     const FrameLabels& before,
                     const FrameLabels& after) {
  Proposal proposal;
  proposal.edit = make_edit(frame, std::move(title), before, after);
  proposal.blank = before;
  proposal.blank.planes.clear();
  proposal.blank.review.clear();
  proposal.blank.plane = Image16();
  proposal.blank.hv = Image8();
  return proposal;
}

std::vector<Proposal> spread_labels(const SpreadJob& job) { return Spreading(job).run(); }

}  // namespace planescope::labels
