// SPDX-License-Identifier: MIT
#include <catch2/catch.hpp>
#include <random>

#include "producer.h"
#include "shapes.h"

using namespace lodestone;
using namespace lodestone::test;

namespace {

ModelData small_data() {
  static const Mesh source = seamed_grid(8, 7);
  const ProducerOptions options{
      .seed = 3, .keep_ratio = 0.1, .move_share = 0.3, .vanish_share = 0.2, .nudge_share = 0.1};
  return progressive::record(source, random_log(source, options), "test");
}

// Either refused, or a model that plays as any other.
bool refused_or_sound(ModelData data) {
  const auto model = ProgressiveModel::from_data(std::move(data));
  if (!model) return !model.error().message.empty();
  const ModelReport report = validate(**model);
  return report.exact && report.in_use_consistent && report.monotone;
}

class Vandal {
 public:
  explicit Vandal(std::uint32_t seed) : random_(seed) {}

  void damage(ModelData& data) {
    switch (below(14)) {
      case 0:
        return bytes(data.shapes);
      case 1:
        return bytes(data.fan_corners);
      case 2:
        return bytes(data.fan_materials);
      case 3:
        return words(data.edits);
      case 4:
        return bytes(data.value_xor);
      case 5:
        return words(data.base_indices);
      case 6:
        return words(data.face_begin);
      case 7:
        return words(data.base_face_counts);
      case 8:
        return bytes(data.errors);
      case 9:
        return words(data.face_features);
      case 10:
        return bytes(data.vertices.positions);
      case 11:
        return bytes(data.vertices.uvs);
      case 12:
        data.corner_bytes = below(6);
        return;
      default:
        data.base_vertex_count += below(3) - 1;
        return;
    }
  }

 private:
  // Another length, or one element overwritten.
  template <class T>
  void bytes(std::vector<T>& array) {
    if (resized(array) || array.empty()) return;
    auto* raw = reinterpret_cast<unsigned char*>(array.data());
    raw[below(array.size() * sizeof(T))] ^= static_cast<unsigned char>(1U << below(8));
  }
  // The same with values near the old one or extreme, which pass more checks than random bytes.
  template <class T>
  void words(std::vector<T>& array) {
    if (resized(array) || array.empty()) return;
    T& word = array[below(array.size())];
    const T choices[] = {word + 1, word - 1, 0, none, none / 2, array[below(array.size())]};
    word = choices[below(6)];
  }
  template <class T>
  bool resized(std::vector<T>& array) {
    const auto what = below(8);
    if (what == 0 && !array.empty()) array.pop_back();
    if (what == 1) array.push_back(array.empty() ? T{} : array.back());
    if (what == 2) array.resize(below(array.size() + 1));
    return what <= 2;
  }

  [[nodiscard]] std::uint32_t below(std::size_t n) { return static_cast<std::uint32_t>(random_() % n); }

  std::mt19937 random_;
};

}  // namespace

TEST_CASE("Damaged model data is refused with a sentence or gives a sound model, never a crash") {
  const ModelData whole = small_data();
  REQUIRE(refused_or_sound(whole));
  REQUIRE(ProgressiveModel::from_data(whole));
  std::uint32_t refused = 0;
  constexpr std::uint32_t tries = 6000;
  for (std::uint32_t seed = 0; seed < tries; ++seed) {
    ModelData data = whole;
    Vandal vandal{seed};
    for (std::uint32_t i = 0; i <= seed % 3; ++i) vandal.damage(data);
    INFO("seed " << seed);
    REQUIRE(refused_or_sound(data));
    refused += ProgressiveModel::from_data(std::move(data)) ? 0 : 1;
  }
  CHECK(refused > tries / 2);
}

TEST_CASE("Each rule of the data is checked and its breach named") {
  const ModelData whole = small_data();
  const auto message = [&](auto&& change) {
    ModelData data = whole;
    change(data);
    const auto model = ProgressiveModel::from_data(std::move(data));
    return model ? std::string{} : model.error().message;
  };
  const auto says = [](const std::string& words) { return Catch::Contains(words); };
  CHECK_THAT(message([](ModelData& d) { d.vertices.positions[3].x = NAN; }), says("not finite"));
  CHECK_THAT(message([](ModelData& d) { d.vertices.uvs.pop_back(); }), says("differ in length"));
  CHECK_THAT(message([](ModelData& d) { d.base_indices[0] = d.base_vertex_count; }), says("no base vertex"));
  CHECK_THAT(message([](ModelData& d) { d.errors.front().error_m = 0.0F; }), says("do not descend"));
  CHECK_THAT(message([](ModelData& d) { d.errors.clear(); }), says("errors"));
  CHECK_THAT(message([](ModelData& d) { d.materials.pop_back(); }), says("materials"));
  CHECK_THAT(message([](ModelData& d) { d.materials[0].texture = 5; }), says("texture"));
  CHECK_THAT(message([](ModelData& d) { d.fan_materials.back() = 9; }), says("material"));
  CHECK_THAT(message([](ModelData& d) { d.shapes.pop_back(); }), says("longer than its records"));
  CHECK_THAT(message([](ModelData& d) { d.fan_corners.resize(d.fan_corners.size() - 3); }), says("end too early"));
  CHECK_THAT(message([](ModelData& d) { d.edits.pop_back(); }), says("too early"));
  CHECK_THAT(message([](ModelData& d) { d.value_xor.pop_back(); }), says("too early"));
  CHECK_THAT(message([](ModelData& d) { d.named_levels.push_back({"far", 1U << 30U}); }), says("named level"));
}
