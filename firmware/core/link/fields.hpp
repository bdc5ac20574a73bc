// SPDX-License-Identifier: Apache-2.0
// Plain values as bytes, little-endian, one after the other without gaps. One template serves both
// directions: `template <class Archive, class T> void Fields(Archive& a, T& t) { a(t.x); ... }`.
//
// Neither class goes past its bytes. A value that does not fit, or is invalid for its type, makes ok() false.
#pragma once

#include <Eigen/Core>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <type_traits>

namespace fovea::link {

class FieldWriter {
 public:
  explicit FieldWriter(std::span<std::uint8_t> bytes) noexcept : bytes_(bytes) {}

  void operator()(bool value) noexcept { Put(value ? 1U : 0U, 1); }
  void operator()(std::uint32_t value) noexcept { Put(value, 4); }
  void operator()(std::uint64_t value) noexcept { Put(value, 8); }
  void operator()(std::int64_t value) noexcept { Put(static_cast<std::uint64_t>(value), 8); }
  void operator()(double value) noexcept { Put(std::bit_cast<std::uint64_t>(value), 8); }
  // 32 bits. (Whether that is int or long depends on the processor.)
  template <class Integer>
  void Int(Integer value) noexcept {
    static_assert(std::is_signed_v<Integer> && sizeof(Integer) == 4);
    Put(static_cast<std::uint32_t>(value), 4);
  }
  // 0 to `most`.
  template <class Integer>
  void Count(Integer value, int most) noexcept {
    ok_ = ok_ && value >= 0 && value <= most;
    Int(value);
  }
  // One of the first `count` values of its type.
  template <class Enum>
  void Choice(Enum value, int count) noexcept {
    ok_ = ok_ && static_cast<int>(value) < count;
    Put(static_cast<std::uint8_t>(value), 1);
  }

  [[nodiscard]] bool ok() const noexcept { return ok_; }
  [[nodiscard]] std::span<const std::uint8_t> written() const noexcept { return bytes_.first(size_); }

 private:
  void Put(std::uint64_t value, std::size_t size) noexcept {
    if (bytes_.size() - size_ < size) {
      ok_ = false;
      return;
    }
    for (std::size_t i = 0; i < size; ++i) {
      bytes_[size_++] = static_cast<std::uint8_t>(value >> (8U * i));
    }
  }

  std::span<std::uint8_t> bytes_;
  std::size_t size_ = 0;
  bool ok_ = true;
};

class FieldReader {
 public:
  explicit FieldReader(std::span<const std::uint8_t> bytes) noexcept : bytes_(bytes) {}

  void operator()(bool& value) noexcept {
    const std::uint64_t bits = Take(1);
    ok_ = ok_ && bits <= 1;
    value = bits == 1;
  }
  void operator()(std::uint32_t& value) noexcept { value = static_cast<std::uint32_t>(Take(4)); }
  void operator()(std::uint64_t& value) noexcept { value = Take(8); }
  void operator()(std::int64_t& value) noexcept { value = static_cast<std::int64_t>(Take(8)); }
  void operator()(double& value) noexcept { value = std::bit_cast<double>(Take(8)); }
  template <class Integer>
  void Int(Integer& value) noexcept {
    static_assert(std::is_signed_v<Integer> && sizeof(Integer) == 4);
    value = static_cast<Integer>(static_cast<std::uint32_t>(Take(4)));
  }
  template <class Integer>
  void Count(Integer& value, int most) noexcept {
    Int(value);
    if (value < 0 || value > most) {
      ok_ = false;
      value = 0;
    }
  }
  template <class Enum>
  void Choice(Enum& value, int count) noexcept {
    const std::uint64_t bits = Take(1);
    ok_ = ok_ && bits < static_cast<std::uint64_t>(count);
    value = ok_ ? static_cast<Enum>(bits) : Enum{};
  }

  // True if all values were there and valid, and nothing is left over.
  [[nodiscard]] bool Done() const noexcept { return ok_ && at_ == bytes_.size(); }

 private:
  std::uint64_t Take(std::size_t size) noexcept {
    if (bytes_.size() - at_ < size) {
      ok_ = false;
      at_ = bytes_.size();
      return 0;
    }
    std::uint64_t value = 0;
    for (std::size_t i = 0; i < size; ++i) {
      value |= static_cast<std::uint64_t>(bytes_[at_++]) << (8U * i);
    }
    return value;
  }

  std::span<const std::uint8_t> bytes_;
  std::size_t at_ = 0;
  bool ok_ = true;
};

// `count` values in a row, at once if the archive can.
template <class Archive, class T>
void Row(Archive& a, T* values, std::size_t count) noexcept {
  if constexpr (requires { a.Row(values, count); }) {
    a.Row(values, count);
  } else {
    for (std::size_t i = 0; i < count; ++i) {
      a(values[i]);
    }
  }
}

template <class Archive, class Array>
void EachOf(Archive& a, Array& values) noexcept {
  Row(a, values.data(), values.size());
}

// Of fixed size, column by column.
template <class Archive, class Matrix>
void Entries(Archive& a, Matrix& m) noexcept {
  static_assert(Matrix::SizeAtCompileTime != Eigen::Dynamic && !Matrix::IsRowMajor);
  Row(a, m.data(), static_cast<std::size_t>(m.size()));
}

template <class Archive, class Pose>
void PoseFields(Archive& a, Pose& pose) noexcept {
  Entries(a, pose.R);
  Entries(a, pose.p);
}

}  // namespace fovea::link
