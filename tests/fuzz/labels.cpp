// Labels: their files, their journal, and other tools' formats.

#include <zip.h>

#include <algorithm>

#include "core/labels/exchange/exchange.hpp"
#include "core/labels/model/label_files.hpp"
#include "core/labels/store/store.hpp"
#include "core/model/error.hpp"
#include "fuzz/fuzz.hpp"
#include "fuzz/pieces.hpp"
#include "fuzz/samples.hpp"

namespace planescope::fuzz {
namespace {

namespace fs = std::filesystem;
using labels::LabelFormat;

void read_label_json(Bytes bytes) {
  const FrameLabels read = labels::parse_label_json(text_of(bytes), 0, "a");
  const std::string written = labels::label_json(0, read);
  require(labels::label_json(0, labels::parse_label_json(written, 0, "a")) == written,
          "labels that change when they are written and read");
}

constexpr std::size_t kJournalHeader = 21;  // planescope.journal/1 and a line end

std::uint32_t number_at(Bytes bytes, std::size_t at) {
  std::uint32_t value = 0;
  for (int i = 3; i >= 0; --i) value = value << 8 | bytes[at + i];
  return value;
}

/// What each record holds.
std::vector<ByteVector> split_journal(Bytes bytes) {
  std::vector<ByteVector> records;
  for (std::size_t at = kJournalHeader; at + 8 < bytes.size();) {
    const Bytes rest = bytes.subspan(at + 8);
    const Bytes record = rest.first(std::min<std::size_t>(number_at(bytes, at), rest.size()));
    records.emplace_back(record.begin(), record.end());
    at += 8 + record.size();
  }
  return records;
}

ByteVector join_journal(const std::vector<ByteVector>& records) {
  const std::string header = "planescope.journal/1\n";
  ByteVector out(header.begin(), header.end());
  const auto put = [](ByteVector& to, std::size_t value) {
    for (int i = 0; i < 4; ++i) to.push_back(static_cast<unsigned char>(value >> (8 * i)));
  };
  for (const ByteVector& record : records) {
    ByteVector summed;
    put(summed, record.size());
    put(out, record.size());
    summed.insert(summed.end(), record.begin(), record.end());
    put(out, checksum(summed));
    out.insert(out.end(), record.begin(), record.end());
  }
  return out;
}

/// As the desktop opens it, goes back and forth in it, and saves.
void read_journal(Bytes bytes) {
  const fs::path dir = memory_folder() / "journal";
  fs::remove_all(dir);
  file_of("journal/journal", bytes);
  labels::work_times(dir);
  labels::LabelStore store(dir, {"ann", [] { return std::int64_t{1}; }});
  for (const int frame : {0, 1}) try {
      store.open(frame, blank_labels(frame));
    } catch (const Error&) {
      // Labels of another image.
    }
  store.history(100);
  try {
    while (store.undo_frame() && store.labels(*store.undo_frame())) store.undo();
    while (store.redo_frame() && store.labels(*store.redo_frame())) store.redo();
  } catch (const Error&) {
    // Of an edit that does not fit its frame.
  }
  for (const int frame : {0, 1})
    if (store.labels(frame) && store.unsaved(frame)) store.save(frame);
}

/// Labels in a foreign format, put on a frame and written again.
void read_exchanged(const fs::path& path, LabelFormat format) {
  const labels::LabelledPoints points = labels::read_labelled(path, format);
  require(points.label.empty() || points.label.size() == points.size(), "labels of other points");
  require(points.pixel.empty() || points.pixel.size() == points.size(), "pixels of other points");
  const labels::LabelGrid& grid = label_grid();
  const FrameLabels taken = labels::labels_of_points(points, grid, std::string(64, 'a'), "a");
  labels::encode_label_files(memory_folder(), 0, taken);
  fs::create_directories(memory_folder() / "written");
  const auto written = labels::write_labelled(memory_folder() / "written" / "a", format,
                                              labels::points_of_labels(taken, grid));
  const auto again = labels::labels_of_points(labels::read_labelled(written.back(), format), grid,
                                              std::string(64, 'a'), "a");
  for (std::size_t i = 0; i < taken.plane.data.size(); ++i) {
    // EVOPS and COCO have no "do not score".
    const bool is_same = again.plane.data[i] == taken.plane.data[i];
    require(is_same || (taken.plane.data[i] == kPlaneIgnore && again.plane.data[i] == 0),
            "labels that change when they are exchanged");
  }
}

void read_npy(Bytes bytes) { read_exchanged(file_of("npy/a.npy", bytes), LabelFormat::evops); }
void read_npz(Bytes bytes) { read_exchanged(file_of("npz/a.npz", bytes), LabelFormat::npz); }
void read_coco(Bytes bytes) { read_exchanged(file_of("coco/a.json", bytes), LabelFormat::coco); }
void read_kitti(Bytes bytes) {
  read_exchanged(file_of("kitti/a.label", bytes), LabelFormat::kitti);
}
void read_label_ply(Bytes bytes) {
  read_exchanged(file_of("label_ply/a.ply", bytes), LabelFormat::ply);
}

/// Name and content of each member.
std::vector<ByteVector> split_npz(Bytes bytes) {
  std::vector<ByteVector> members;
  zip_t* archive = zip_open(file_of("npz/split.npz", bytes).c_str(), ZIP_RDONLY, nullptr);
  if (!archive) return members;
  for (zip_int64_t i = 0; i < zip_get_num_entries(archive, 0); ++i) {
    const auto at = static_cast<zip_uint64_t>(i);
    zip_file_t* file = zip_fopen_index(archive, at, 0);
    if (!file) continue;
    ByteVector content(1 << 16);
    content.resize(static_cast<std::size_t>(
        std::max<zip_int64_t>(0, zip_fread(file, content.data(), content.size()))));
    zip_fclose(file);
    PieceWriter piece;
    piece.text(zip_get_name(archive, at, 0));
    piece.rest(content);
    members.push_back(piece.take());
  }
  zip_discard(archive);
  return members;
}

ByteVector join_npz(const std::vector<ByteVector>& members) {
  const fs::path path = memory_folder() / "npz" / "joined.npz";
  zip_t* archive = zip_open(path.c_str(), ZIP_CREATE | ZIP_TRUNCATE, nullptr);
  if (!archive) return {};
  std::vector<ByteVector> contents;
  contents.reserve(members.size());
  for (const ByteVector& member : members) {
    PieceReader in(member);
    const std::string name = in.text();
    contents.push_back(in.rest());
    zip_source_t* source =
        zip_source_buffer(archive, contents.back().data(), contents.back().size(), 0);
    if (zip_file_add(archive, name.c_str(), source, ZIP_FL_OVERWRITE) < 0) zip_source_free(source);
  }
  if (zip_close(archive) < 0) zip_discard(archive);
  return bytes_of_file(path);
}

}  // namespace

std::vector<Target> label_targets() {
  return {{"label_json", read_label_json, split_json, join_json},
          {"journal", read_journal, split_journal, join_journal},
          {"npy", read_npy},
          {"npz", read_npz, split_npz, join_npz},
          {"coco", read_coco, split_json, join_json},
          {"kitti", read_kitti},
          {"label_ply", read_label_ply}};
}

}  // namespace planescope::fuzz
