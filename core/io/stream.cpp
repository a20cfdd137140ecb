// Frames from standard input: a line of JSON about the camera, then one image after another, as raw
// counts or PNG.

#include <fmt/format.h>
#include <poll.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <deque>
#include <nlohmann/json.hpp>

#include "core/io/image/png.hpp"
#include "core/io/readers.hpp"
#include "core/model/error.hpp"
#include "core/model/file_bytes.hpp"
#include "core/model/json.hpp"

namespace planescope::io {
namespace {

constexpr const char* kStream = "standard input";
constexpr const char* kStreamSchema = "planescope.stream/1";
constexpr const char* kStreamFormats[] = {"raw", "png"};
constexpr int kMostSide = 1 << 15;  // of an image [px]

class DescriptorStream : public FrameStream {
 public:
  DescriptorStream(int descriptor, const RecordingOptions& options, bool keeps_all)
      : descriptor_(descriptor), keeps_all_(keeps_all) {
    const auto header = parse_json<nlohmann::ordered_json>(read_header(), kStream);
    sidecar_ = read_place(kStream, header, [&](const JsonPlace& place) {
      place.schema({kStreamSchema});
      place.has_only(
          {"schema", "width", "height", "format", "intrinsics", "depth_unit_m", "gravity"});
      info_.width = place.at("width").whole(1, kMostSide);
      info_.height = place.at("height").whole(1, kMostSide);
      is_png_ = place.at("format").choice(kStreamFormats) == 1;
      return sidecar_of(place, kStream);
    });
    info_.path = kStream;  // name in errors
    settle_camera(options, sidecar_, {}, info_);
    info_.path = "-";
    info_.format = fmt::format("stream of {} images", kStreamFormats[is_png_]);
    info_.color_note = "none";
    expect_within_read_limit(static_cast<double>(raw_bytes()), kStream);
  }

  const RecordingInfo& info() const override { return info_; }
  int frame_count() const override { return count_; }

  bool wait_for_frame(const std::stop_token& stop) override {
    std::size_t length = raw_bytes();
    if (is_png_) {
      unsigned char prefix[4];  // little-endian
      if (!read_whole(prefix, stop, "length")) return false;
      length = prefix[0] | prefix[1] << 8 | prefix[2] << 16 | std::size_t{prefix[3]} << 24;
      const std::size_t most = 2 * raw_bytes() + (1 << 16);  // PNG expands data only slightly
      if (length == 0 || length > most)
        throw Error(
            fmt::format("{}: frame {}: a {}-byte PNG; expected 1 to {} bytes for {}x{} pixels",
                        kStream, count_, length, most, info_.width, info_.height));
    }
    std::vector<unsigned char> bytes(length);
    if (!read_whole(bytes, stop, "image")) {
      if (is_png_ && !stop.stop_requested())
        throw Error(fmt::format("{}: frame {} is truncated: received 0 of {} bytes", kStream,
                                count_, length));
      return false;
    }
    if (!keeps_all_) kept_.clear();
    kept_.push_back(std::move(bytes));
    ++count_;
    return true;
  }

  Frame frame(int i) const override {
    Frame frame;
    frame.index = i;
    frame.name = fmt::format("{:06}", i);
    frame.depth = depth(i);
    frame.depth_unit_m = info_.depth_unit_m;
    frame.intrinsics = info_.intrinsics;
    apply_sidecar(sidecar_, frame);
    return frame;
  }
  double timestamp_s(int) const override { return 0; }
  std::string frame_hash(int i) const override { return sha256_of_depth(depth(i)); }

 private:
  std::size_t raw_bytes() const {
    return sizeof(std::uint16_t) * static_cast<std::size_t>(info_.width) * info_.height;
  }

  /// Fills `bytes` until the stream ends or a stop is requested. Returns the number of bytes read.
  std::size_t read_some(std::span<unsigned char> bytes, const std::stop_token& stop) const {
    constexpr int kLook_ms = 100;  // maximum delay of a stop
    std::size_t got = 0;
    while (got < bytes.size() && !stop.stop_requested()) {
      pollfd wanted{descriptor_, POLLIN, 0};
      if (::poll(&wanted, 1, kLook_ms) == 0) continue;
      const ssize_t read = ::read(descriptor_, bytes.data() + got, bytes.size() - got);
      if (read < 0 && errno == EINTR) continue;
      if (read < 0) throw Error(fmt::format("{}: cannot be read: {}", kStream, error_text(errno)));
      if (read == 0) break;
      got += static_cast<std::size_t>(read);
    }
    return got;
  }

  /// Returns false at the end of the stream and on a stop. Throws Error if the stream ends within
  /// `bytes`.
  bool read_whole(std::span<unsigned char> bytes, const std::stop_token& stop, const char* what) {
    const std::size_t got = read_some(bytes, stop);
    if (got == bytes.size()) return true;
    if (got > 0 && !stop.stop_requested())
      throw Error(fmt::format("{}: frame {} is truncated: received {} of {} bytes of its {}",
                              kStream, count_, got, bytes.size(), what));
    return false;
  }

  std::string read_header() const {
    constexpr std::size_t kMostBytes = 1 << 16;
    std::string header;
    for (unsigned char byte = 0; header.size() < kMostBytes; header += static_cast<char>(byte))
      if (read_some({&byte, 1}, {}) == 0 || byte == '\n') break;
    if (!header.starts_with('{') || header.size() == kMostBytes)
      throw Error(fmt::format("{}: no header ({} bytes read); expected a JSON line with schema {}",
                              kStream, header.size(), kStreamSchema));
    return header;
  }

  Image16 depth(int i) const {
    const int first = count_ - static_cast<int>(kept_.size());
    const std::vector<unsigned char>& bytes = kept_.at(static_cast<std::size_t>(i - first));
    const std::string name = fmt::format("{}: frame {}", kStream, i);
    Image16 depth;
    if (is_png_) {
      depth = decode_png_16(bytes, name);
    } else {
      depth = Image16(info_.width, info_.height);
      std::memcpy(depth.data.data(), bytes.data(), bytes.size());
    }
    if (depth.width != info_.width || depth.height != info_.height)
      throw Error(fmt::format("{}: {}x{} pixels; expected {}x{}, as declared in the header", name,
                              depth.width, depth.height, info_.width, info_.height));
    return depth;
  }

  int descriptor_;
  bool keeps_all_;
  bool is_png_ = false;
  RecordingInfo info_;
  Sidecar sidecar_;                              // facts in the header
  std::deque<std::vector<unsigned char>> kept_;  // the last frames as received
  int count_ = 0;
};

}  // namespace

std::unique_ptr<FrameStream> open_stream(int descriptor,
                                         const RecordingOptions& options,
                                         bool keeps_all) {
  if (!options.topic.empty())
    throw Error(
        fmt::format("{}: a stream of frames has no topics; --topic requires a bag", kStream));
  return std::make_unique<DescriptorStream>(descriptor, options, keeps_all);
}

}  // namespace planescope::io
