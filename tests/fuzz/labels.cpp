// Fuzz targets for labels: their files, their journal, and other tools' formats.

#include "core/labels/exchange/exchange.hpp"
#include "core/labels/model/label_files.hpp"
#include "core/labels/store/store.hpp"
#include "core/model/error.hpp"
#include "fuzz/fuzz.hpp"

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

/// Opens a journal as the desktop does, goes back and forth in it, and saves.
void read_journal(Bytes bytes) {
  const fs::path dir = memory_folder() / "journal";
  fs::remove_all(dir);
  file_of("journal/journal", bytes);
  labels::work_times(dir);
  labels::LabelStore store(dir, {"ann", [] { return std::int64_t{1}; }});
  for (const int frame : {0, 1}) try {
      store.open(frame, blank_labels(frame));
    } catch (const Error&) {
      // These labels belong to another image.
    }
  store.history(100);
  try {
    while (store.undo_count() > 0 && store.labels(store.undo_frames().front())) store.undo();
    while (store.redo_count() > 0 && store.labels(store.redo_frames().front())) store.redo();
  } catch (const Error&) {
    // An edit that does not fit its frame.
  }
  for (const int frame : {0, 1})
    if (store.labels(frame) && store.unsaved(frame)) store.save(frame);
}

/// Reads labels in a foreign format into a frame and writes them again.
void read_exchanged(const fs::path& path, LabelFormat format) {
  const labels::LabeledPoints points = labels::read_labeled(path, format);
  require(points.label.empty() || points.label.size() == points.size(), "labels of other points");
  require(points.pixel.empty() || points.pixel.size() == points.size(), "pixels of other points");
  const labels::LabelGrid& grid = label_grid();
  const FrameLabels taken = labels::labels_of_points(points, grid, std::string(64, 'a'), "a");
  labels::encode_label_files(memory_folder(), 0, taken);
  fs::create_directories(memory_folder() / "written");
  const auto written = labels::write_labeled(memory_folder() / "written" / "a", format,
                                             labels::points_of_labels(taken, grid));
  const auto again = labels::labels_of_points(labels::read_labeled(written.back(), format), grid,
                                              std::string(64, 'a'), "a");
  for (std::size_t i = 0; i < taken.plane.data.size(); ++i) {
    // EVOPS and COCO do not support "do not score".
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

}  // namespace

std::vector<Target> label_targets() {
  return {{"label_json", read_label_json},
          {"journal", read_journal},
          {"npy", read_npy},
          {"npz", read_npz},
          {"coco", read_coco},
          {"kitti", read_kitti},
          {"label_ply", read_label_ply}};
}

}  // namespace planescope::fuzz
