// SPDX-License-Identifier: MIT
#include "gltf_surfaces.h"

#include <algorithm>

#include "gltf_colors.h"

namespace lodestone {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* webp = "image/webp";

// glTF takes JPEG and PNG, and WebP by an extension that tiles use; anything else is turned into PNG.
Result<EncodedTexture> image_for_gltf(const Texture& texture, GltfLook look) {
  auto encoded = encoded_texture(texture);
  if (!encoded || encoded->mime_type == "image/jpeg" || encoded->mime_type == "image/png") return encoded;
  if (look == GltfLook::Photograph && encoded->mime_type == webp) return encoded;
  auto image = decode_image(encoded->bytes, texture.name);
  if (!image) return image.error();
  auto png = encode_png(*image);
  if (!png) return png.error();
  return EncodedTexture{std::move(*png), "image/png"};
}

}  // namespace

void GltfSurfaces::plan_textures(const Mesh& mesh, Json& root, GltfLayout& layout, std::vector<Warning>& warnings) {
  bool has_webp = false;
  for (const Texture& texture : mesh.textures) {
    texture_ids_.push_back(-1);
    auto encoded = image_for_gltf(texture, look_);
    if (!encoded) {
      warnings.push_back({"a texture was left out: it " + encoded.error().message, encoded.error().where});
      continue;
    }
    texture_ids_.back() = static_cast<int>(images_.size());
    images_.push_back(std::move(*encoded));
    const EncodedTexture& image = images_.back();
    root["images"].push_back({{"name", texture.name},
                              {"mimeType", image.mime_type},
                              {"bufferView", layout.add_view(image.bytes.size(), 0)}});
    if (image.mime_type != webp) {
      root["textures"].push_back({{"source", texture_ids_.back()}});
      continue;
    }
    Json json;
    json["extensions"]["EXT_texture_webp"] = {{"source", texture_ids_.back()}};
    root["textures"].push_back(std::move(json));
    has_webp = true;
  }
  for (const char* list : {"extensionsUsed", "extensionsRequired"}) {
    if (has_webp) root[list].push_back("EXT_texture_webp");
  }
  if (look_ == GltfLook::Lit || images_.empty()) return;
  constexpr int linear = 9729;
  constexpr int linear_mipmap_linear = 9987;
  constexpr int clamp_to_edge = 33071;
  root["samplers"].push_back(
      {{"magFilter", linear}, {"minFilter", linear_mipmap_linear}, {"wrapS", clamp_to_edge}, {"wrapT", clamp_to_edge}});
  for (Json& texture : root["textures"]) texture["sampler"] = 0;
  root["extensionsUsed"].push_back("KHR_materials_unlit");
}

Json GltfSurfaces::material_json(const Material& material) const {
  Json pbr{{"metallicFactor", 0.0}};
  const glm::vec4& c = material.base_color;
  const auto linear = [](float value) { return srgb_to_linear(std::clamp(static_cast<double>(value), 0.0, 1.0)); };
  pbr["baseColorFactor"] = {linear(c.r), linear(c.g), linear(c.b), std::clamp(static_cast<double>(c.a), 0.0, 1.0)};
  const bool textured = material.texture != none && texture_ids_[material.texture] >= 0;
  if (textured) pbr["baseColorTexture"] = {{"index", texture_ids_[material.texture]}};
  Json json{{"name", material.name}, {"pbrMetallicRoughness", std::move(pbr)}};
  if (material.alpha_cutoff > 0.0F) {
    json["alphaMode"] = "MASK";
    json["alphaCutoff"] = material.alpha_cutoff;
  } else if (material.transparent()) {
    json["alphaMode"] = "BLEND";
  }
  if (material.double_sided) json["doubleSided"] = true;
  if (textured && look_ == GltfLook::Photograph) json["extensions"]["KHR_materials_unlit"] = Json::object();
  return json;
}

void GltfSurfaces::plan(const Mesh& mesh, GltfLook look, Json& root, GltfLayout& layout,
                        std::vector<Warning>& warnings) {
  look_ = look;
  plan_textures(mesh, root, layout, warnings);
  for (const Material& material : mesh.materials) root["materials"].push_back(material_json(material));
}

}  // namespace lodestone
