#include <fcntl.h>
#include <malloc.h>
#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <functional>
#include <random>

#include "core/io/recording.hpp"
#include "core/model/file_bytes.hpp"
#include "unit/io/sample_bags.hpp"

// measure_big_bag [MEGABYTES [none|lz4|bz2]]: writes a bag of that size (1100, lz4) to the folder
// for temporary files, prints what opening it and reading random frames of it cost, whole and cut,
// and removes it. Not a test: it asserts nothing about time and takes a disk.
namespace planescope::io {
namespace {

using namespace testing_bags;

double memory_mb() {
  std::ifstream status("/proc/self/status");
  for (std::string line; std::getline(status, line);) {
    if (line.starts_with("RssAnon:")) return std::stod(line.substr(8)) / 1024;
  }
  return 0;
}

/// Makes the system forget what it holds of a file.
void forget(const std::filesystem::path& path) {
  const int file = ::open(path.c_str(), O_RDONLY);
  ::fsync(file);
  ::posix_fadvise(file, 0, 0, POSIX_FADV_DONTNEED);
  ::close(file);
}

/// How much of a file the system has read since.
double read_mb(const std::filesystem::path& path) {
  const std::size_t size = std::filesystem::file_size(path);
  const auto page = static_cast<std::size_t>(::sysconf(_SC_PAGESIZE));
  const int file = ::open(path.c_str(), O_RDONLY);
  void* address = ::mmap(nullptr, size, PROT_READ, MAP_SHARED, file, 0);
  std::vector<unsigned char> pages((size + page - 1) / page);
  ::mincore(address, size, pages.data());
  ::munmap(address, size);
  ::close(file);
  const auto held = std::count_if(pages.begin(), pages.end(), [](auto p) { return p & 1; });
  return static_cast<double>(held * page) / (1 << 20);
}

double elapsed_ms(const std::function<void()>& action) {
  const auto start = std::chrono::steady_clock::now();
  action();
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start)
      .count();
}

/// A 640x480 recording with IMU at 250 Hz whose images pack about as well as real ones.
void write_big_bag(const std::filesystem::path& path,
                   const std::string& compression,
                   int megabytes) {
  std::mt19937 random(1);
  ImageMessage depth = depth_message(0, 0);
  ImageMessage color = color_message(0, 0);
  for (ImageMessage* image : {&depth, &color}) {
    image->width = 640;
    image->height = 480;
    image->pixels.assign(std::size_t(640) * 480 * (image == &depth ? 2 : 3), 0);
    for (std::size_t i = 0; i < image->pixels.size(); i += 1 + (random() & 3)) {
      image->pixels[i] = static_cast<unsigned char>(random() & 15);
    }
  }
  BagFormat format;
  format.compression = compression;
  format.messages_per_chunk = 10;
  BagWriter bag(format);
  bag.add(kSdkDepth + "/info/camera_info", "sensor_msgs/CameraInfo", 1,
          camera_info_message(640, 480, {380, 380, 320, 240}));
  for (int i = 0; bag.bytes() < std::size_t(megabytes) << 20; ++i) {
    const auto time_ns = static_cast<std::uint64_t>(i) * 33'333'333 + 1000;
    depth.seq = static_cast<std::uint32_t>(i);
    depth.stamp_s = color.stamp_s = 100 + 1e-9 * static_cast<double>(time_ns);
    bag.add(kSdkDepth + "/image/data", "sensor_msgs/Image", time_ns, image_message(depth));
    bag.add(kSdkColor + "/image/data", "sensor_msgs/Image", time_ns + 10, image_message(color));
    for (int k = 0; k < 8; ++k) {
      bag.add(kSdkAccel + "/imu/data", "sensor_msgs/Imu", time_ns + 4'000'000u * k,
              imu_message(k, 0, Vec3d(0, -9.8, 0)));
    }
  }
  write_file_bytes(path, bag.finish());
}

void measure(const std::filesystem::path& path) {
  malloc_trim(0);
  for (const bool cut : {false, true}) {
    if (cut) std::filesystem::resize_file(path, std::filesystem::file_size(path) - 100'000);
    const double memory_before_mb = memory_mb();
    forget(path);
    std::unique_ptr<Recording> recording;
    const double open_ms = elapsed_ms([&] { recording = open_recording(path); });
    const double opening_read_mb = read_mb(path);
    const double memory_used_mb = memory_mb() - memory_before_mb;
    std::printf(
        "%s: %ju MB, %d frames\n  opened in %.1f ms, reading %.1f MB of the file and "
        "taking %.1f MB of memory\n",
        cut ? "cut" : "whole", static_cast<std::uintmax_t>(std::filesystem::file_size(path) >> 20),
        recording->frame_count(), open_ms, opening_read_mb, memory_used_mb);
    for (const bool again : {false, true}) {
      std::mt19937 random(2);
      std::vector<double> frames_ms;
      for (int k = 0; k < 40; ++k) {
        const int i = static_cast<int>(random() % recording->frame_count());
        frames_ms.push_back(elapsed_ms([&] { recording->frame(i); }));
      }
      std::sort(frames_ms.begin(), frames_ms.end());
      std::printf("  random frame %s: %.1f ms (median), %.1f ms (worst of 40)\n",
                  again ? "from the page cache" : "from the disk", frames_ms[20], frames_ms.back());
    }
    std::fflush(stdout);
  }
}

}  // namespace
}  // namespace planescope::io

int main(int argc, char** argv) {
  const int megabytes = argc > 1 ? std::atoi(argv[1]) : 1100;
  const std::string compression = argc > 2 ? argv[2] : "lz4";
  const auto path = std::filesystem::temp_directory_path() / "planescope_big.bag";
  planescope::io::write_big_bag(path, compression, megabytes);
  planescope::io::measure(path);
  std::filesystem::remove(path);
}
