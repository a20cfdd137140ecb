#pragma once

// Arrays to and from Python through the buffer protocol (PEP 3118) or __array_interface__. Avoids
// numpy's C API, so that one build works with every version of numpy, and without numpy.

#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <memory>
#include <planescope/core.hpp>
#include <string>
#include <vector>

namespace planescope_python {

namespace py = pybind11;
namespace ps = planescope;

using Shape = std::vector<py::ssize_t>;

// ---- Arrays out ----

/// Memory with a type and a shape. numpy.asarray() and memoryview() are views of it.
struct Array {
  const void* data = nullptr;
  std::string format;  // PEP 3118
  py::ssize_t item_size = 0;
  Shape shape;
  std::shared_ptr<const void> owner;  // keeps the memory
  bool readonly = false;              // true for the library's memory

  py::buffer_info buffer() const {
    Shape strides(shape.size());
    py::ssize_t stride = item_size;
    for (std::size_t k = shape.size(); k-- > 0; stride *= shape[k]) strides[k] = stride;
    return py::buffer_info(const_cast<void*>(data), item_size, format,
                           static_cast<py::ssize_t>(shape.size()), shape, strides, readonly);
  }
};

/// PEP 3118 format of a type; for records it includes the names of the fields.
template <typename T>
std::string format_of() {
  if constexpr (requires { T::kFormat; })
    return T::kFormat;
  else
    return py::format_descriptor<T>::format();
}
template <>
inline std::string format_of<ps::Event>() {
  return "T{B:type:B:case:B:stage:B:label:i:node:i:plane:i:other:i:point:f:value:}";
}

/// A view of the library's memory. Copies `of`, which keeps the memory alive.
template <typename T, typename Owner>
Array view_of(const T* data, Shape shape, const Owner& of) {
  return {data, format_of<T>(), sizeof(T), std::move(shape), std::make_shared<const Owner>(of),
          true};
}

/// An array that owns its memory. `T` consists of `Item`s; an empty shape: one row per value.
template <typename Item, typename T>
Array array_of(std::vector<T>&& values, Shape shape = {}) {
  static_assert(sizeof(T) % sizeof(Item) == 0);
  if (shape.empty()) {
    shape.push_back(static_cast<py::ssize_t>(values.size()));
    if (sizeof(T) != sizeof(Item)) shape.push_back(sizeof(T) / sizeof(Item));
  }
  const auto kept = std::make_shared<const std::vector<T>>(std::move(values));
  return {kept->data(), format_of<Item>(), sizeof(Item), std::move(shape), kept, false};
}

template <std::size_t N>
Array rows_of(std::vector<std::array<double, N>> rows) {
  return array_of<double>(std::move(rows));
}
inline Array vector_of(const ps::Vec3& p) {
  return array_of<double>(std::vector(p.begin(), p.end()));
}
inline Array transform_of(const ps::Transform& t) {
  return array_of<double>(std::vector(t.begin(), t.end()), {4, 4});
}

// ---- Arrays in ----

/// An array of the caller, in any layout.
struct Input {
  py::object given, memory;  // keeps the memory that `info` refers to
  py::buffer_info info;
  char kind = 0;  // u, i, f; 0: not numbers
  bool swapped = false;
  const char* what;

  Input(const py::object& array, const char* name) : given(array), memory(array), what(name) {
    std::string format;
    try {
      if (PyObject_CheckBuffer(given.ptr())) {
        info = py::reinterpret_borrow<py::buffer>(given).request();
        format = info.format;
      } else {
        format = read_interface(given.attr("__array_interface__").cast<py::dict>());
      }
    } catch (const ps::Error&) {
      throw;
    } catch (const std::exception&) {  // from Python or pybind11
      fail("an array of numbers");
    }
    const std::size_t prefix =
        !format.empty() && std::string_view("@=<>!|").find(format[0]) != std::string_view::npos;
    const bool big = prefix == 1 && (format[0] == '>' || format[0] == '!');
    swapped = prefix == 1 && format[0] != '@' && format[0] != '=' && format[0] != '|' &&
              big != (std::endian::native == std::endian::big);
    if (format.size() != prefix + 1) return;
    const char code = format[prefix];
    kind = std::strchr("BHILQN", code)   ? 'u'
           : std::strchr("bhilqn", code) ? 'i'
           : std::strchr("fd", code)     ? 'f'
                                         : 0;
  }

  bool is(char k, py::ssize_t size) const { return kind == k && info.itemsize == size; }
  std::string text() const {
    std::string shape;
    for (const py::ssize_t n : info.shape) shape += (shape.empty() ? "" : ", ") + std::to_string(n);
    if (info.ndim == 1) shape += ",";
    const std::string type = kind == 'u'   ? "uint"
                             : kind == 'i' ? "int"
                             : kind == 'f' ? "float"
                                           : "format " + info.format;
    return type + (kind == 0 ? "" : std::to_string(8 * info.itemsize)) + " of shape (" + shape +
           ")";
  }
  [[noreturn]] void fail(const std::string& expected) const {
    const std::string found =
        info.ptr == nullptr && info.ndim == 0
            ? "a " + py::str(py::type::of(given).attr("__name__")).cast<std::string>()
            : text();
    throw ps::Error(std::string(what) + ": " + found + "; expected " + expected);
  }

  /// The memory itself if it consists of rows of T without gaps within rows, otherwise null.
  template <typename T>
  const T* rows(std::size_t& stride) const {
    const auto size = static_cast<py::ssize_t>(sizeof(T));
    if (swapped || info.itemsize != size || info.strides[1] != size ||
        info.strides[0] % size != 0 || info.strides[0] < info.shape[1] * size ||
        reinterpret_cast<std::uintptr_t>(info.ptr) % sizeof(T) != 0)
      return nullptr;
    stride = static_cast<std::size_t>(info.strides[0] / size);
    return static_cast<const T*>(info.ptr);
  }

  /// All values in C order: the last index varies fastest.
  template <typename To>
  std::vector<To> values() const {
    std::vector<To> all;
    all.reserve(static_cast<std::size_t>(info.size));
    const py::ssize_t size = info.itemsize;
    if (kind == 'f') return size == 4 ? copy<float>(all) : copy<double>(all);
    if (kind == 'u')
      return size == 1   ? copy<std::uint8_t>(all)
             : size == 2 ? copy<std::uint16_t>(all)
             : size == 4 ? copy<std::uint32_t>(all)
                         : copy<std::uint64_t>(all);
    return size == 1   ? copy<std::int8_t>(all)
           : size == 2 ? copy<std::int16_t>(all)
           : size == 4 ? copy<std::int32_t>(all)
                       : copy<std::int64_t>(all);
  }

 private:
  template <typename From, typename To>
  std::vector<To>& copy(std::vector<To>& all) const {
    const auto last = static_cast<std::size_t>(info.ndim) - 1;
    Shape at(last + 1, 0);
    for (py::ssize_t row = 0; info.size > 0 && row < info.size / info.shape[last]; ++row) {
      const char* from = static_cast<const char*>(info.ptr);
      for (std::size_t k = 0; k < last; ++k) from += at[k] * info.strides[k];
      for (py::ssize_t i = 0; i < info.shape[last]; ++i, from += info.strides[last]) {
        std::array<char, sizeof(From)> bytes;
        std::copy_n(from, bytes.size(), bytes.begin());
        if (swapped) std::reverse(bytes.begin(), bytes.end());
        all.push_back(static_cast<To>(std::bit_cast<From>(bytes)));
      }
      for (std::size_t k = last; k-- > 0 && ++at[k] == info.shape[k];) at[k] = 0;
    }
    return all;
  }

  /// Sets `info`; returns the format.
  std::string read_interface(const py::dict& interface) {
    const auto get = [&](const char* key) -> py::object {
      return interface.contains(key) ? py::object(interface[key]) : py::none();
    };
    const auto type = get("typestr").cast<std::string>();
    const py::ssize_t size = std::stoi(type.substr(2));
    const auto shape = get("shape").cast<Shape>();
    if (std::ranges::any_of(shape, [](py::ssize_t n) { return n < 0; }))
      fail("a shape without negative sizes");
    Shape strides(shape.size());
    py::ssize_t stride = size;
    for (std::size_t k = shape.size(); k-- > 0; stride *= shape[k]) strides[k] = stride;
    if (const py::object own = get("strides"); !own.is_none()) strides = own.cast<Shape>();
    void* data = nullptr;
    if (const py::object at = get("data"); py::isinstance<py::tuple>(at)) {
      data = reinterpret_cast<void*>(at.cast<py::tuple>()[0].cast<std::uintptr_t>());
    } else {
      if (!at.is_none()) memory = at;
      const py::buffer_info bytes = py::reinterpret_borrow<py::buffer>(memory).request();
      py::ssize_t first = 0, last = size;
      for (std::size_t k = 0; k < shape.size() && k < strides.size(); ++k)
        (strides[k] < 0 ? first : last) += strides[k] * (shape[k] - 1);
      if (stride != 0 && (first < 0 || last > bytes.size * bytes.itemsize))
        fail("a buffer large enough for its shape");
      data = bytes.ptr;
    }
    const std::string codes = type[1] == 'u'   ? "?BH?I???Q"
                              : type[1] == 'i' ? "?bh?i???q"
                              : type[1] == 'f' ? "????f???d"
                                               : "?????????";
    const char code = size >= 0 && size < 9 ? codes[static_cast<std::size_t>(size)] : '?';
    info = py::buffer_info(data, size, std::string(1, code), static_cast<py::ssize_t>(shape.size()),
                           shape, strides, true);
    return std::string(1, type[0]) + code;
  }
};

}  // namespace planescope_python
