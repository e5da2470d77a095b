// SPDX-License-Identifier: MIT
// The fields of a header as a cereal archive: one text for writing and reading. Only headers' .cpp files include this.
#pragma once

#include <cereal/archives/portable_binary.hpp>
#include <cereal/types/string.hpp>
#include <cstdint>
#include <sstream>
#include <string>
#include <type_traits>
#include <vector>

#include <lodestone/mesh.h>

#include "columns.h"

namespace lodestone::model_file {

// cereal's own loaders trust counts; these let nothing grow beyond what the bytes left could fill.
template <class Archive>
class Fields {
 public:
  static constexpr bool loading = Archive::is_loading::value;
  Fields(Archive& archive, std::uint64_t bytes) : archive_(archive), bytes_(bytes) {}

  template <class T>
  requires std::is_arithmetic_v<T>
  void operator()(T& value) { archive_(value); }
  void operator()(bool& value) {
    auto byte = static_cast<std::uint8_t>(value ? 1 : 0);
    archive_(byte);
    value = byte != 0;
  }
  template <class T>
  requires std::is_enum_v<T>
  void operator()(T& value) {
    auto number = static_cast<std::underlying_type_t<T>>(value);
    archive_(number);
    value = static_cast<T>(number);
  }
  void operator()(std::string& text) {
    const std::size_t size = count(text.size());
    if constexpr (loading) text.resize(size);
    archive_(cereal::binary_data(text.data(), size));
  }
  void operator()(Material& m) {
    all(m.name, m.base_color.r, m.base_color.g, m.base_color.b, m.base_color.a, m.texture, m.alpha_cutoff,
        m.double_sided);
  }
  void operator()(Texture& t) { all(t.name, t.path, t.mime_type); }
  void operator()(Feature& f) { all(f.id, f.semantic_class, f.parent); }
  template <class T>
  void operator()(std::vector<T>& list) {
    const std::size_t size = count(list.size());
    if constexpr (loading) {
      // One by one: elements are larger in memory than in the file, and the bytes may end long before the count.
      for (std::size_t i = 0; i < size; ++i) (*this)(list.emplace_back());
    } else {
      for (T& item : list) (*this)(item);
    }
  }
  // Anything else brings a function describe(fields, value) that names its members.
  template <class T>
  requires requires(Fields& fields, T& value) { describe(fields, value); }
  void operator()(T& value) { describe(*this, value); }

  template <class... T>
  void all(T&... values) {
    ((*this)(values), ...);
  }

 private:
  std::size_t count(std::size_t size) {
    auto number = static_cast<std::uint32_t>(size);
    archive_(number);
    if (loading && number > bytes_) throw cereal::Exception("a count is larger than the header");
    return number;
  }

  Archive& archive_;
  std::uint64_t bytes_;
};

template <class T>
[[nodiscard]] Bytes archived(const T& value) {
  std::ostringstream stream;
  {
    cereal::PortableBinaryOutputArchive archive{stream, cereal::PortableBinaryOutputArchive::Options::LittleEndian()};
    Fields fields{archive, 0};
    fields(const_cast<T&>(value));  // one text for both directions; writing changes nothing
  }
  const std::string text = stream.str();
  return {text.begin(), text.end()};
}

// False if the bytes end too early or make no sense.
template <class T>
[[nodiscard]] bool unarchive(const Bytes& bytes, T& value) {
  try {
    std::istringstream stream{std::string{bytes.begin(), bytes.end()}};
    cereal::PortableBinaryInputArchive archive{stream};
    Fields fields{archive, bytes.size()};
    fields(value);
  } catch (const cereal::Exception&) {
    return false;
  }
  return true;
}

}  // namespace lodestone::model_file
