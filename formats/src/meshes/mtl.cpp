// SPDX-License-Identifier: MIT
#include "mtl.h"

#include <algorithm>
#include <cmath>

#include "line_reader.h"

namespace lodestone {
namespace {

float share(float value) { return std::isfinite(value) ? std::clamp(value, 0.0F, 1.0F) : 1.0F; }

// A texture statement: options with their values, then the file's name, which may hold blanks.
std::string texture_name(Words& words, Warnings& warnings, const std::string& place) {
  for (;;) {
    Words ahead = words;
    const std::string_view option = ahead.next();
    if (option.size() < 2 || option.front() != '-') return std::string{words.rest()};
    words = ahead;
    if (option == "-s" || option == "-o" || option == "-t") {
      float ignored = 0.0F;
      bool identity = true;
      for (int i = 0; i < 3 && words.number(ignored); ++i) identity &= ignored == (option == "-s" ? 1.0F : 0.0F);
      if (!identity) warnings.add("a texture's scale, offset or turbulence is not used", place);
    } else if (option == "-mm") {
      (void)words.next();
      (void)words.next();
    } else {
      (void)words.next();  // every other option of the format has one value
    }
  }
}

bool word_is(std::string_view word, std::string_view lower_case) {
  return std::equal(word.begin(), word.end(), lower_case.begin(), lower_case.end(),
                    [](char a, char b) { return (a >= 'A' && a <= 'Z' ? a + 32 : a) == b; });
}

}  // namespace

void read_mtl(const Input& input, const Context& context, MtlLibrary& library, Warnings& warnings) {
  LineReader lines{input, context};
  std::string_view line;
  MtlMaterial unused;
  MtlMaterial* material = &unused;
  bool has_d = false;
  while (lines.next(line)) {
    Words words{line};
    const std::string_view key = words.next();
    if (word_is(key, "newmtl")) {
      const auto [at, is_new] = library.try_emplace(std::string{words.rest()});
      if (!is_new) warnings.add("a material is defined twice; the first stays", lines.place());
      unused = {};
      material = is_new ? &at->second : &unused;
      has_d = false;
    } else if (word_is(key, "kd")) {
      glm::vec3 color{1.0F};
      if (!words.number(color.r)) {
        warnings.add("a colour that is not given as RGB is not used", lines.place());
        continue;
      }
      color.g = color.b = color.r;
      if (words.number(color.g)) (void)words.number(color.b);
      for (int c = 0; c < 3; ++c) material->color[c] = share(color[c]);
    } else if (word_is(key, "d")) {
      Words ahead = words;
      if (ahead.next() == "-halo") words = ahead;
      float alpha = 1.0F;
      if (words.number(alpha)) material->color.a = share(alpha);
      has_d = true;
    } else if (word_is(key, "tr")) {
      float through = 0.0F;
      if (words.number(through) && !has_d) material->color.a = 1.0F - share(through);
    } else if (word_is(key, "map_kd")) {
      material->texture = texture_name(words, warnings, lines.place());
    } else if (word_is(key, "map_d")) {
      material->has_mask = true;
    }
  }
  if (!lines.status()) warnings.add("a material library was not read to its end", input.name());
}

}  // namespace lodestone
