#pragma once

#include <cstdint>
#include <map>
#include <ostream>
#include <string>
#include <vector>

#include "core/model/frame.hpp"

namespace planescope::io {

/// Writes depth images and their colour as realsense-ros records them: an MCAP file of CDR
/// messages, a zstd chunk for each frame, with an index. Depth counts stay as they are, whatever
/// their unit: a sidecar tells it (write_recording_facts()).
class McapWriter {
 public:
  explicit McapWriter(std::ostream& out);
  void add(const Frame& frame);
  void finish();

 private:
  struct Channel {
    std::uint16_t id = 0;
    std::uint64_t messages = 0;
  };
  void write(const std::string& bytes);
  void message(const std::string& topic, const char* type, double stamp_s, const std::string& cdr);
  void end_chunk();

  std::ostream& out_;
  std::uint64_t position_ = 0;
  std::map<std::string, Channel> channels_;
  std::string chunk_;
  std::string schemas_, channel_records_, chunk_indexes_;  // of the summary, grouped by kind
  std::map<std::uint16_t, std::string> entries_;           // of the chunk, by channel
  std::uint64_t messages_ = 0, first_ns_ = 0, last_ns_ = 0, chunk_first_ns_ = 0, chunk_last_ns_ = 0;
  std::uint32_t chunks_ = 0, frames_ = 0;
};

}  // namespace planescope::io
