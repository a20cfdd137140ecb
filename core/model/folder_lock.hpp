#pragma once

#include <filesystem>
#include <string>

#include "core/model/file_bytes.hpp"

namespace planescope {

/// Held by the one instance that may write into a folder, in DIR/lock. The lock ends with the
/// process, however that ends; the file's text is for people only. Releasing the lock removes the
/// file.
class FolderLock {
 public:
  FolderLock() = default;
  ~FolderLock() { release(); }
  FolderLock(FolderLock&& other) noexcept = default;
  FolderLock& operator=(FolderLock&& other) noexcept;

  /// Makes DIR/lock where needed, not DIR.
  static FolderLock take(const std::filesystem::path& dir, const std::string& user);

  bool is_held() const { return file_.is_open(); }
  bool is_held_by_other() const { return by_other_; }
  /// Why it is not held: "held by ann, process 4711 on lab3 since 14:02".
  const std::string& why_not() const { return why_not_; }

 private:
  void release();

  std::filesystem::path path_;
  FileDescriptor file_;
  bool by_other_ = false;
  std::string why_not_;
};

}  // namespace planescope
