// SPDX-License-Identifier: MIT
// Based on: Baerentzen et al. 2006, Single-pass wireframe rendering (edges from barycentric coordinates).
#include "shaders.h"

namespace lodestone::render {

const char* const surface_vertex_shader = R"(
layout(location = 0) in vec3 position;
layout(location = 1) in vec3 normal;
layout(location = 2) in vec2 uv;
layout(location = 3) in vec4 color;
layout(location = 4) in vec3 target_position;
layout(location = 5) in vec3 target_normal;
layout(location = 6) in vec2 target_uv;
layout(location = 7) in vec4 target_color;
uniform float morph;  // 0: none; 1: all at the target
uniform mat4 to_eye;
uniform mat4 to_clip;
#ifdef EDGES
#define OUT(name) v_##name
#else
#define OUT(name) f_##name
#endif
out vec3 OUT(eye);
out vec3 OUT(normal);
out vec2 OUT(uv);
out vec4 OUT(color);
void main() {
  vec4 eye = to_eye * vec4(mix(position, target_position, morph), 1.0);
  vec3 turned = normal;
  if (morph > 0.0) {
    turned = mix(normal, target_normal, morph);
    float size = length(turned);
    turned = size > 1e-6 ? turned / size : target_normal;
  }
  OUT(eye) = eye.xyz;
  OUT(normal) = mat3(to_eye) * turned;
  OUT(uv) = mix(uv, target_uv, morph);
  OUT(color) = mix(color, target_color, morph);
  gl_Position = to_clip * eye;
}
)";

// Adds barycentric coordinates and the triangle's size, the geometric mean of its longest edge and its height over it.
const char* const surface_geometry_shader = R"(
layout(triangles) in;
layout(triangle_strip, max_vertices = 3) out;
in vec3 v_eye[];
in vec3 v_normal[];
in vec2 v_uv[];
in vec4 v_color[];
out vec3 f_eye;
out vec3 f_normal;
out vec2 f_uv;
out vec4 f_color;
out vec3 f_barycentric;
flat out float f_size_m;
void main() {
  float size_m = sqrt(length(cross(v_eye[1] - v_eye[0], v_eye[2] - v_eye[0])));
  for (int i = 0; i < 3; ++i) {
    f_eye = v_eye[i];
    f_normal = v_normal[i];
    f_uv = v_uv[i];
    f_color = v_color[i];
    f_barycentric = vec3(i == 0, i == 1, i == 2);
    f_size_m = size_m;
    gl_Position = gl_in[i].gl_Position;
    EmitVertex();
  }
  EndPrimitive();
}
)";

const char* const surface_fragment_shader = R"(
in vec3 f_eye;
in vec3 f_normal;
in vec2 f_uv;
in vec4 f_color;
out vec4 pixel;
uniform vec4 base_color;      // linear
uniform sampler2D image;      // decoded to linear by the sampler; white where there is none
uniform float alpha_cutoff;
uniform int unlit;
uniform int has_normals;
uniform vec3 up;              // the world's, in eye space
uniform float share;          // of the pixels: below 1 where it comes, below 0 where it leaves
#ifdef EDGES
in vec3 f_barycentric;
flat in float f_size_m;
uniform float wire_px;        // 0 = none
uniform int lod_colors;
uniform float model_size_m;

vec3 lod_ramp(float t) {
  vec3 stops[5] = vec3[](vec3(0.04, 0.14, 0.55), vec3(0.03, 0.42, 0.50), vec3(0.16, 0.56, 0.12),
                         vec3(0.85, 0.62, 0.05), vec3(0.70, 0.08, 0.05));
  float x = clamp(t, 0.0, 1.0) * 4.0;
  int i = min(int(x), 3);
  return mix(stops[i], stops[i + 1], x - float(i));
}
#endif

vec3 to_linear(vec3 c) { return mix(c / 12.92, pow((c + 0.055) / 1.055, vec3(2.4)), step(0.04045, c)); }

// The normal that faces the viewer. The geometric one comes from screen derivatives, so that it needs no orientation
// of the faces and glides with a geomorph; smooth normals are turned to its side.
vec3 shading_normal() {
  vec3 g = cross(dFdx(f_eye), dFdy(f_eye));
  float area = length(g);
  vec3 toward = -normalize(f_eye);
  g = area > 0.0 ? g / area : toward;
  if (dot(g, toward) < 0.0) g = -g;
  if (has_normals == 0) return g;
  float size = length(f_normal);
  if (size < 1e-3) return g;
  vec3 n = f_normal / size;
  return dot(n, g) < 0.0 ? -n : n;
}

// A key light over the viewer's left shoulder, a weak one from the right, and a sky that is brighter above: faces that
// differ in direction differ in brightness, and none is black or burnt out.
float light(vec3 n) {
  vec3 key = normalize(vec3(-0.75, 0.05, 0.50) + 0.50 * up);
  vec3 fill = normalize(vec3(0.85, -0.05, 0.35));
  float sky = 0.27 + 0.13 * dot(n, up);
  return sky + 0.58 * max(dot(n, key), 0.0) + 0.16 * max(dot(n, fill), 0.0);
}

// Interleaved gradient noise (Jimenez 2014): even in every small neighbourhood.
float noise(vec2 place) { return fract(52.9829189 * fract(dot(floor(place), vec2(0.06711056, 0.00583715)))); }

void main() {
  vec4 texel = texture(image, f_uv);
  if (share < 1.0) {
    float n = noise(gl_FragCoord.xy);
    if (share >= 0.0 ? n >= share : n < 1.0 + share) discard;
  }
  float alpha = base_color.a * texel.a * f_color.a;
  if (alpha_cutoff > 0.0) {
    // Sharpened about the cutoff, so that the rim of a cut-out keeps its place in smaller mip levels.
    if (texel.a < alpha_cutoff) discard;
    alpha = base_color.a;
  }
  vec3 albedo = base_color.rgb * texel.rgb * to_linear(f_color.rgb);
#ifdef EDGES
  if (lod_colors != 0) {
    albedo = lod_ramp((log2(max(f_size_m, 1e-9) / model_size_m) + 9.0) / 7.0);
    alpha = 1.0;
  }
#endif
  vec3 shaded = unlit != 0 ? albedo : albedo * light(shading_normal());
#ifdef EDGES
  if (wire_px > 0.0) {
    vec3 width = fwidth(f_barycentric) * wire_px;
    vec3 off = smoothstep(vec3(0.0), width, f_barycentric);
    float line = 1.0 - min(off.x, min(off.y, off.z));
    // Where triangles are no larger than the lines, the lines fade instead of blackening the surface.
    float room = 1.0 - smoothstep(0.15, 0.9, max(width.x, max(width.y, width.z)));
    shaded = mix(shaded, vec3(0.012, 0.014, 0.02), line * (0.15 + 0.6 * room));
    alpha = max(alpha, line * 0.6);
  }
#endif
  pixel = vec4(shaded, alpha);
}
)";

const char* const picture_vertex_shader = R"(
out vec2 f_place;
void main() {
  f_place = vec2(gl_VertexID == 1 ? 2.0 : 0.0, gl_VertexID == 2 ? 2.0 : 0.0);
  gl_Position = vec4(f_place * 2.0 - 1.0, 0.0, 1.0);
}
)";

const char* const background_fragment_shader = R"(
in vec2 f_place;
out vec4 pixel;
uniform vec3 top;
uniform vec3 bottom;
void main() { pixel = vec4(mix(bottom, top, f_place.y), 1.0); }
)";

const char* const present_fragment_shader = R"(
out vec4 pixel;
uniform sampler2D first;   // sRGB textures: fetches are linear
uniform sampler2D second;
uniform float second_share;
uniform int samples;       // texels per pixel and axis
vec3 area(sampler2D picture) {
  ivec2 corner = ivec2(gl_FragCoord.xy) * samples;
  vec3 sum = vec3(0.0);
  for (int y = 0; y < samples; ++y)
    for (int x = 0; x < samples; ++x) sum += texelFetch(picture, corner + ivec2(x, y), 0).rgb;
  return sum / float(samples * samples);
}
void main() {
  vec3 c = area(first);
  if (second_share > 0.0) c = mix(c, area(second), second_share);
  c = clamp(c, 0.0, 1.0);
  pixel = vec4(mix(c * 12.92, 1.055 * pow(c, vec3(1.0 / 2.4)) - 0.055, step(0.0031308, c)), 1.0);
}
)";

}  // namespace lodestone::render
