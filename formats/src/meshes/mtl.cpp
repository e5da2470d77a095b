// SPDX-License-Identifier: MIT
#include "mtl.h"

#include <algorithm>
#include <cmath>

#include "line_reader.h"

namespace lodestone {
namespace {

float share(float value) { return std::isfinite(value) ? std::clamp(value, 0.0F, 1.0F) : 1.0F; }

// A texture statement: options with their values, then the file's name, which may hold blanks.
std::string_view texture_name(Words& words, Warnings& warnings, const std::string& place) {
  for (;;) {
    Words ahead = words;
    const std::string_view option = ahead.next();
    if (option.size() < 2 || option.front() != '-') return words.file_name();
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

// A name may hold " #", so what follows is a comment only where the file is found without it. Who has the library in
// a folder of its own names textures from there.
std::string known_from(const std::filesystem::path& model_folder, const Input& library, std::string_view text) {
  const auto before = [&](std::size_t comment) { return Words{text.substr(0, comment)}.rest(); };
  for (const std::string_view name :
       {text, before(text.rfind(" #")), before(text.find(" #")), before(text.find("\t#"))}) {
    if (library.folder() != model_folder) {
      if (const auto file = find_beside(library.folder(), name)) {
        const auto relative = file->lexically_relative(model_folder);
        return relative.empty() ? file->string() : relative.string();
      }
    }
    if (find_beside(model_folder, name)) return std::string{name};
  }
  return std::string{text};
}

}  // namespace

std::vector<std::string> library_names(const std::filesystem::path& model_folder, std::string_view text) {
  Words words{text};
  const std::string all{words.file_name()};
  std::vector<std::string> names;
  Words parts{all};
  for (std::string_view part = parts.next(); !part.empty() && part.front() != '#'; part = parts.next()) {
    names.emplace_back(part);
  }
  if (names.empty() || find_beside(model_folder, all)) return {all};
  return names;
}

void read_mtl(const Input& input, const std::filesystem::path& model_folder, const Context& context,
              MtlLibrary& library, Warnings& warnings) {
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
      material->place = lines.place();
      material->texture = known_from(model_folder, input, texture_name(words, warnings, material->place));
    } else if (word_is(key, "map_d")) {
      material->mask = known_from(model_folder, input, texture_name(words, warnings, lines.place()));
    }
  }
  if (!lines.status()) warnings.add("a material library was not read to its end", input.name());
}

}  // namespace lodestone
