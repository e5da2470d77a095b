// SPDX-License-Identifier: MIT
#include "cluster_file/header.h"

#include <cmath>

#include "model_file/fields.h"

namespace lodestone {

// Found by the archive where the types live.
template <class F>
void describe(F& fields, Range& r) {
  fields.all(r.begin, r.end);
}

template <class F>
void describe(F& fields, Sphere& s) {
  fields.all(s.center.x, s.center.y, s.center.z, s.radius_m);
}

template <class F>
void describe(F& fields, LodGroup& g) {
  fields.all(g.bounds, g.error_m, g.nodes, g.links, g.parts, g.parent_count, g.triangle_count, g.made_triangle_count);
}

template <class F>
void describe(F& fields, LodLink& l) {
  fields.all(l.maker, l.nodes);
}

// Single precision: the writer has rounded them outwards.
template <class F>
void describe(F& fields, LodNode& n) {
  float numbers[4] = {static_cast<float>(n.bounds.center.x), static_cast<float>(n.bounds.center.y),
                      static_cast<float>(n.bounds.center.z), static_cast<float>(n.bounds.radius_m)};
  fields.all(numbers[0], numbers[1], numbers[2], numbers[3], n.triangle_count);
  n.bounds = {{numbers[0], numbers[1], numbers[2]}, numbers[3]};
}

template <class F>
void describe(F& fields, LodPart& p) {
  fields.all(p.nodes, p.page);
}

template <class F>
void describe(F& fields, LodGraph& g) {
  fields.all(g.groups, g.links, g.nodes, g.parts, g.page_count);
}

template <class F>
void describe(F& fields, Cluster& c) {
  fields.all(c.vertices, c.triangles, c.sections, c.level);
}

template <class F>
void describe(F& fields, ClusterSection& s) {
  fields.all(s.material, s.triangles);
}

template <class F>
void describe(F& fields, ClusterLevel& l) {
  fields.all(l.clusters, l.groups, l.triangles, l.mean_fill, l.error_m);
}

template <class F>
void describe(F& fields, ClusterRoot& r) {
  fields.all(r.node, r.cause);
}

namespace cluster_file {

template <class F>
void describe(F& fields, PageEntry& p) {
  fields.all(p.offset, p.stored_bytes, p.raw_bytes, p.compressed, p.checksum, p.nodes);
}

template <class F>
void describe(F& fields, TextureEntry& t) {
  fields.all(t.texture, t.bytes, t.checksum);
}

template <class F>
void describe(F& fields, Header& h) {
  ClusterGraph& o = h.outline;
  fields.all(h.generator, o.origin.x, o.origin.y, o.origin.z, o.crs, h.normals, h.uvs, h.colors);
  fields.all(h.grid.bits, h.grid.corner.x, h.grid.corner.y, h.grid.corner.z, h.grid.step_m);
  fields.all(o.materials, o.textures, o.features, o.graph, o.clusters, o.sections, o.face_features, o.levels, o.roots,
             h.pages, h.textures);
}

namespace {

class Check {
 public:
  explicit Check(const Header& header) : header_(header), outline_(header.outline) {}

  const char* run() {
    const Grid& grid = header_.grid;
    const double corner = grid.corner.x + grid.corner.y + grid.corner.z;
    if (grid.bits < 1 || grid.bits > 24 || !(grid.step_m > 0.0) || !std::isfinite(grid.step_m + corner)) {
      return "the grid makes no sense";
    }
    if (!validate(outline_.graph).ok()) return "the graph does not keep its promises";
    if (outline_.clusters.size() != outline_.graph.nodes.size()) return "clusters and nodes disagree";
    if (!clusters_ok()) return "a cluster is miscounted";
    if (!pages_ok()) return "the pages do not hold the nodes in order";
    for (const ClusterRoot& root : outline_.roots) {
      if (root.node >= outline_.clusters.size()) return "a root is no node";
    }
    for (const TextureEntry& entry : header_.textures) {
      if (entry.texture >= outline_.textures.size()) return "an embedded texture has no name";
    }
    for (const Material& material : outline_.materials) {
      if (material.texture != none && material.texture >= outline_.textures.size())
        return "a material names no texture";
    }
    return nullptr;
  }

 private:
  // Clusters follow each other, node by node, in vertices, triangles and sections.
  [[nodiscard]] bool clusters_ok() const {
    std::uint32_t vertex = 0;
    std::uint32_t triangle = 0;
    std::uint32_t section = 0;
    for (std::size_t n = 0; n < outline_.clusters.size(); ++n) {
      const Cluster& c = outline_.clusters[n];
      if (c.vertices.begin != vertex || c.triangles.begin != triangle || c.sections.begin != section) return false;
      if (c.vertices.end < vertex || c.vertices.size() > 255 || c.triangles.end < triangle ||
          c.triangles.size() > 255 || c.sections.end < section || c.sections.end > outline_.sections.size()) {
        return false;
      }
      if (c.triangles.size() != outline_.graph.nodes[n].triangle_count) return false;
      if (!sections_ok(c)) return false;
      vertex = c.vertices.end;
      triangle = c.triangles.end;
      section = c.sections.end;
    }
    const bool features_ok = outline_.face_features.empty() || outline_.face_features.size() == triangle;
    for (const FeatureId f : outline_.face_features) {
      if (f != none && f >= outline_.features.size()) return false;
    }
    return features_ok && section == outline_.sections.size();
  }

  [[nodiscard]] bool sections_ok(const Cluster& c) const {
    std::uint32_t at = c.triangles.begin;
    for (std::uint32_t s = c.sections.begin; s != c.sections.end; ++s) {
      const ClusterSection& section = outline_.sections[s];
      if (section.triangles.begin != at || section.triangles.end <= at ||
          section.material >= outline_.materials.size()) {
        return false;
      }
      at = section.triangles.end;
    }
    return at == c.triangles.end;
  }

  [[nodiscard]] bool pages_ok() const {
    if (header_.pages.size() != outline_.graph.page_count) return false;
    NodeId node = 0;
    std::uint64_t offset = 0;
    for (const PageEntry& page : header_.pages) {
      if (page.nodes.begin != node || page.nodes.end <= node || page.offset != offset) return false;
      if (page.raw_bytes > max_page_bytes || (!page.compressed && page.raw_bytes != page.stored_bytes)) return false;
      if (!model_file::unpack_is_sane(page.raw_bytes, page.stored_bytes)) return false;
      node = page.nodes.end;
      offset += page.stored_bytes;
    }
    if (node != outline_.graph.nodes.size()) return false;
    for (const LodPart& part : outline_.graph.parts) {
      const Range& nodes = header_.pages[part.page].nodes;
      if (part.nodes.begin < nodes.begin || part.nodes.end > nodes.end) return false;
    }
    return true;
  }

  const Header& header_;
  const ClusterGraph& outline_;
};

}  // namespace

Bytes write_header(const Header& header) { return model_file::seal(lodg_file, model_file::archived(header)); }

std::optional<HeaderFault> read_header(std::span<const std::uint8_t> bytes, Header& header) {
  Bytes raw;
  if (auto fault = model_file::unseal(bytes, raw)) return fault;
  if (!model_file::unarchive(raw, header)) return HeaderFault{ErrorCode::BadData, model_file::damaged_header};
  if (const char* fault = Check{header}.run(); fault != nullptr) return HeaderFault{ErrorCode::BadData, fault};
  return std::nullopt;
}

}  // namespace cluster_file
}  // namespace lodestone
