#pragma once

// Private data of the public library's objects, shared by its sources only.

#include <array>
#include <memory>
#include <mutex>
#include <stdexcept>
#include <utility>

#include "core/debug/replay/run.hpp"
#include "core/model/error.hpp"
#include "core/planes/pipeline/pipeline.hpp"
#include "core/planes/result/analyze.hpp"
#include "planescope/core.hpp"

namespace planescope::v0 {

struct Options::Data {
  planes::PipelineOptions options;
  bool crop_is_set = false;  // set by its own name, `range_for_clouds`
};

namespace detail {

using FramePointer = std::shared_ptr<const ::planescope::Frame>;

struct SegmenterData {
  planes::PipelineOptions options;
  planes::ChosenClassifier chosen;
};

struct ResultData {
  ResultData(v0::Frame of, planes::PipelineOptions by, planes::FrameResult&& found_in)
      : frame(std::move(of)), options(std::move(by)), result(std::move(found_in)) {}

  v0::Frame frame;
  planes::PipelineOptions options;
  planes::FrameResult result;
  Gravity gravity;
  std::vector<std::int32_t> plane_of;  // per pixel or point
  std::vector<v0::Label> label_of;

  // Computed on first use.
  mutable std::once_flag once;
  mutable planes::FramePlanes found;
  mutable std::vector<Plane> planes;
  void find_planes() const;
};

struct TraceData {
  v0::Frame frame;
  std::shared_ptr<const debug::Run> run;
};

/// Creates the library's objects from core's types, and gives access to their data.
struct PLANESCOPE_API Access {
  static v0::Frame frame(::planescope::Frame&& frame);
  static const ::planescope::Frame& frame(const v0::Frame& frame) {
    return *static_cast<const ::planescope::Frame*>(frame.data_.get());
  }
  static const planes::PipelineOptions& options(const Options& options) {
    return options.data_->options;
  }
  static const SegmenterData& segmenter(const Segmenter& segmenter) { return *segmenter.data_; }
  static Result result(std::shared_ptr<const ResultData> data) {
    Result result;
    result.data_ = std::move(data);
    return result;
  }
  static const ResultData& result(const Result& result) { return *result.data_; }
  static Trace trace(std::shared_ptr<const TraceData> data) {
    Trace trace;
    trace.data_ = std::move(data);
    return trace;
  }
  static const TraceData& trace(const Trace& trace) { return *trace.data_; }
};

inline Vec3 vec3(const Vec3d& p) { return {p.x(), p.y(), p.z()}; }
inline Vec3d vec3(const Vec3& p) { return {p[0], p[1], p[2]}; }
PLANESCOPE_API Transform transform(const Pose& pose);
/// Throws Error that begins with `what` if `t` is not rigid.
PLANESCOPE_API Pose pose(const Transform& t, const char* what);
PLANESCOPE_API Result make_result(const v0::Frame& frame,
                                  const planes::PipelineOptions& options,
                                  planes::FrameResult&& found);
PLANESCOPE_API Camera camera(const Intrinsics& intrinsics);

/// Throws Error without hints about the command line, which would not help a caller of the library.
[[noreturn]] PLANESCOPE_API void throw_for_programs(const std::string& message);

/// Calls a function and converts errors of core and of the standard library.
template <typename Call>
auto guarded(const Call& call) {
  try {
    return call();
  } catch (const Error&) {
    throw;
  } catch (const std::exception& error) {
    throw_for_programs(::planescope::message_of(error));
  }
}

}  // namespace detail
}  // namespace planescope::v0
