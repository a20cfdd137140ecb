#pragma once

// A float array aligned for SIMD registers.

#include <algorithm>
#include <cstddef>
#include <memory>
#include <new>

namespace planescope {

/// Floats aligned to cache lines; uninitialized unless a value is given. Move-only.
class Buffer {
 public:
  Buffer() = default;
  explicit Buffer(std::size_t size) { resize(size); }
  Buffer(std::size_t size, float value) : Buffer(size) { fill(value); }

  /// Discards the values; reuses the memory if it is large enough.
  void resize(std::size_t size) {
    if (size > capacity_) {
      values_.reset(static_cast<float*>(::operator new(size * sizeof(float), kAlignment)));
      capacity_ = size;
    }
    size_ = size;
  }

  void fill(float value) { std::fill_n(data(), size_, value); }
  float* data() { return values_.get(); }
  const float* data() const { return values_.get(); }
  std::size_t size() const { return size_; }
  float& operator[](std::size_t i) { return values_.get()[i]; }
  float operator[](std::size_t i) const { return values_.get()[i]; }

 private:
  static constexpr std::align_val_t kAlignment{64};
  struct Free {
    void operator()(float* p) const { ::operator delete(p, kAlignment); }
  };
  std::unique_ptr<float, Free> values_;
  std::size_t size_ = 0, capacity_ = 0;
};

}  // namespace planescope
