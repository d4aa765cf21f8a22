#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <cstring>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <tuple>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include "resilin/core/error.hpp"
#include "resilin/core/hash.hpp"
#include "resilin/core/members.hpp"
#include "resilin/core/types.hpp"

/// Plain data as bytes and back, bit by bit: numbers, texts, lists, and structs that have said what they
/// consist of (core/members.hpp).
namespace resilin {

static_assert(std::endian::native == std::endian::little, "archives are little-endian");

/// Numbers and enums, whose bytes are written as memory holds them.
template <class T>
concept PlainNumber = std::is_arithmetic_v<T> || std::is_enum_v<T>;

/// A matrix or vector of Eigen's with numbers of one size.
template <class T>
concept FixedMatrix = requires { T::SizeAtCompileTime; } && (T::SizeAtCompileTime > 0);

/// Writes values one after another into a string of bytes, for `ArchiveReader`.
class ArchiveWriter {
 public:
  template <class... T>
  void operator()(const T&... values) {
    (put(values), ...);
  }
  std::string take() { return std::move(bytes_); }

 private:
  void put_bytes(const void* data, std::size_t size) { bytes_.append(static_cast<const char*>(data), size); }
  void put_count(std::size_t count) { put(static_cast<std::uint64_t>(count)); }

  template <PlainNumber T>
  void put(const T& value) {
    put_bytes(&value, sizeof(T));
  }
  template <FixedMatrix T>
  void put(const T& matrix) {
    put_bytes(matrix.data(), sizeof(matrix));
  }
  void put(const VectorX& values) {
    put_count(static_cast<std::size_t>(values.size()));
    put_bytes(values.data(), static_cast<std::size_t>(values.size()) * sizeof(double));
  }
  void put(const std::string& text) {
    put_count(text.size());
    put_bytes(text.data(), text.size());
  }
  template <class T>
  void put(const std::vector<T>& values) {
    put_count(values.size());
    if constexpr (PlainNumber<T>) {
      put_bytes(values.data(), values.size() * sizeof(T));
    } else {
      for (const T& value : values) put(value);
    }
  }
  template <class T, std::size_t n>
  void put(const std::array<T, n>& values) {
    for (const T& value : values) put(value);
  }
  template <class T>
  void put(const std::optional<T>& value) {
    put(value.has_value());
    if (value) put(*value);
  }
  template <class Key, class T>
  void put(const std::map<Key, T>& entries) {
    put_count(entries.size());
    for (const auto& [key, value] : entries) (*this)(key, value);
  }
  template <class First, class Second>
  void put(const std::pair<First, Second>& pair) {
    (*this)(pair.first, pair.second);
  }
  template <class... T>
  void put(const std::variant<T...>& value) {
    put_count(value.index());
    std::visit([this](const auto& form) { this->put(form); }, value);
  }
  template <HasMembers T>
  void put(const T& value) {
    std::apply(*this, members(value).values);
  }

  std::string bytes_;
};

/// Reads what ArchiveWriter has written; no count is trusted before memory is taken for it.
class ArchiveReader {
 public:
  /// `place` begins and `cure` ends the message of the InputError that damaged bytes bring.
  ArchiveReader(std::string_view bytes, std::string place, std::string cure = {})
      : rest_(bytes), place_(std::move(place)), cure_(std::move(cure)) {}

  template <class... T>
  void operator()(T&... values) {
    (get(values), ...);
  }
  [[noreturn]] void fail() const {
    throw InputError(place_, "data as they were written", "truncated or damaged ones", cure_);
  }
  /// Fails when there is more.
  void end() const {
    if (!rest_.empty()) fail();
  }

 private:
  void get_bytes(void* data, std::size_t size) {
    if (size > rest_.size()) fail();
    if (size > 0) std::memcpy(data, rest_.data(), size);
    rest_.remove_prefix(size);
  }
  /// Number of things that take at least `least_bytes` each.
  std::size_t count(std::size_t least_bytes) {
    std::uint64_t number = 0;
    get(number);
    if (number > rest_.size() / least_bytes) fail();
    return static_cast<std::size_t>(number);
  }

  template <PlainNumber T>
  void get(T& value) {
    if constexpr (std::is_same_v<T, bool>) {
      unsigned char byte = 0;
      get_bytes(&byte, 1);
      value = byte != 0;
    } else {
      get_bytes(&value, sizeof(T));
    }
  }
  template <FixedMatrix T>
  void get(T& matrix) {
    get_bytes(matrix.data(), sizeof(matrix));
  }
  void get(VectorX& values) {
    values.resize(static_cast<Eigen::Index>(count(sizeof(double))));
    get_bytes(values.data(), static_cast<std::size_t>(values.size()) * sizeof(double));
  }
  void get(std::string& text) {
    text.resize(count(1));
    get_bytes(text.data(), text.size());
  }
  template <class T>
  void get(std::vector<T>& values) {
    if constexpr (PlainNumber<T>) {
      values.resize(count(sizeof(T)));
      get_bytes(values.data(), values.size() * sizeof(T));
    } else {
      const std::size_t size = count(1);
      values.clear();
      for (std::size_t i = 0; i < size; ++i) get(values.emplace_back());
    }
  }
  template <class T, std::size_t n>
  void get(std::array<T, n>& values) {
    for (T& value : values) get(value);
  }
  template <class T>
  void get(std::optional<T>& value) {
    bool is_there = false;
    get(is_there);
    value.reset();
    if (is_there) get(value.emplace());
  }
  template <class Key, class T>
  void get(std::map<Key, T>& entries) {
    entries.clear();
    for (std::size_t left = count(1); left > 0; --left) {
      Key key;
      get(key);
      get(entries[key]);
    }
  }
  template <class First, class Second>
  void get(std::pair<First, Second>& pair) {
    (*this)(pair.first, pair.second);
  }
  template <class... T>
  void get(std::variant<T...>& value) {
    std::uint64_t index = 0, i = 0;
    get(index);
    const bool is_known = ((i++ == index && (get(value.template emplace<T>()), true)) || ...);
    if (!is_known) fail();
  }
  template <HasMembers T>
  void get(T& value) {
    std::apply(*this, members(value).values);
  }

  std::string_view rest_;
  std::string place_, cure_;
};

/// `content` between `mark`, a line that says what it is, and the hash of both.
inline std::string sealed(std::string_view mark, std::string_view content) {
  std::string image(mark);
  image += content;
  const std::uint64_t hash = hash_of(image);
  image.append(reinterpret_cast<const char*>(&hash), sizeof(hash));
  return image;
}

/// The content again. @throws InputError  naming `place`, when the mark is another or the hash is wrong
inline std::string_view unsealed(std::string_view image, std::string_view mark, const std::string& place,
                                 const std::string& cure) {
  if (!image.starts_with(mark))
    throw InputError(place, "data of this version of the program", "something else", cure);
  std::uint64_t hash = 0;
  const bool has_room = image.size() >= mark.size() + sizeof(hash);
  const std::size_t end = has_room ? image.size() - sizeof(hash) : image.size();
  ArchiveReader reader(image.substr(end), place, cure);
  reader(hash);
  if (hash != hash_of(image.substr(0, end))) reader.fail();
  return image.substr(mark.size(), end - mark.size());
}

}  // namespace resilin
