#pragma once

#include <string>

namespace planescope {

/// A bar on stderr, only where that is a terminal; gone again when it is destroyed.
class Progress {
 public:
  Progress(std::string what, int total);
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  void show(int done, const std::string& now);
  /// A line that stays, above the bar; without a terminal too.
  void print(const std::string& line);

 private:
  std::string what_;
  int total_;
  bool visible_;
};

}  // namespace planescope
