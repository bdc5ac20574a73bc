// SPDX-License-Identifier: Apache-2.0
// The renderer's shaders. Lengths in metres, positions in frame B (suffix _B) or C (suffix _C).
#pragma once

namespace fovea::sim::shaders {

// Meshes are lit per vertex and shadowed per pixel: a software renderer executes each pixel operation 300 000
// times. The light's values come from light.hpp.
inline constexpr const char* kLight = R"glsl(
uniform vec3 u_sun_B;        // unit vector towards the light
uniform vec3 u_sun_light;
uniform vec3 u_sky_from_above;
uniform vec3 u_sky_from_below;
uniform vec3 u_eye_B;
uniform float u_gain;        // brightness of the light times the camera's gain
uniform mat4 u_shadow_of_B;  // B to the shadow map, 0 to 1
uniform float u_shadow_lift;  // offset from the surface against self-shadowing [m]

vec3 Sky(vec3 n_B) { return mix(u_sky_from_below, u_sky_from_above, 0.5 * n_B.z + 0.5); }
vec3 Sun(vec3 n_B) { return u_sun_light * max(dot(n_B, u_sun_B), 0.0); }
float Shine(vec3 p_B, vec3 n_B) {
  float shine = max(dot(n_B, normalize(u_sun_B + normalize(u_eye_B - p_B))), 0.0);
  shine *= shine; shine *= shine; shine *= shine; shine *= shine; shine *= shine;
  return shine;
}
vec3 InShadowMap(vec3 p_B, vec3 n_B) { return (u_shadow_of_B * vec4(p_B + u_shadow_lift * n_B, 1.0)).xyz; }
)glsl";

// Needs a preamble that defines SHADOW_TAPS and SHADOW_SPREAD.
inline constexpr const char* kShadow = R"glsl(
uniform sampler2DShadow u_shadow;
uniform float u_shadow_texel;
const vec2 kTaps[16] = vec2[16](
  vec2(-0.62, -0.40), vec2(0.60, -0.51), vec2(-0.38, 0.66), vec2(0.48, 0.42),
  vec2(-0.05, -0.93), vec2(0.94, 0.08), vec2(-0.93, 0.16), vec2(0.08, 0.95),
  vec2(-0.28, -0.12), vec2(0.22, -0.17), vec2(-0.10, 0.28), vec2(0.26, 0.14),
  vec2(-0.72, -0.72), vec2(0.75, 0.70), vec2(0.38, -0.86), vec2(-0.70, 0.60));

float Lit(vec3 s) {
  float lit = 0.0;
  for (int i = 0; i < SHADOW_TAPS; ++i) {
    lit += texture(u_shadow, vec3(s.xy + kTaps[i] * (SHADOW_SPREAD * u_shadow_texel), s.z));
  }
  return lit * (1.0 / float(SHADOW_TAPS));
}
)glsl";

// Rectangles of pixels, as far away as can be: left, top, width, height.
inline constexpr const char* kAreaVertex = R"glsl(
layout(location = 0) in ivec4 a_area;
uniform vec2 u_size_px;
void main() {
  ivec2 corner = a_area.xy + ivec2(gl_VertexID & 1, gl_VertexID >> 1) * a_area.zw;
  gl_Position = vec4(2.0 * vec2(corner) / u_size_px - 1.0, 1.0, 1.0);
}
)glsl";

inline constexpr const char* kMeshVertex = R"glsl(
layout(location = 0) in vec3 a_position;
layout(location = 1) in vec3 a_normal;
layout(location = 2) in vec3 a_colour;
uniform mat4 u_clip_of_B;
uniform mat4 u_B_of_mesh;
out vec3 sky;  // light that shadows do not remove, times the surface's colour
out vec3 sun;  // light that a shadow removes
out vec3 in_shadow_map;
void main() {
  vec4 p = u_B_of_mesh * vec4(a_position, 1.0);
  vec3 n_B = mat3(u_B_of_mesh) * a_normal;
  sky = a_colour * Sky(n_B) * u_gain;
  sun = (a_colour * Sun(n_B) + vec3(0.10 * Shine(p.xyz, n_B))) * u_gain;
  in_shadow_map = InShadowMap(p.xyz, n_B);
  gl_Position = u_clip_of_B * p;
}
)glsl";

inline constexpr const char* kMeshFragment = R"glsl(
in vec3 sky;
in vec3 sun;
in vec3 in_shadow_map;
out vec4 pixel;
void main() { pixel = vec4(sky + sun * Lit(in_shadow_map), 1.0); }
)glsl";

// The hem of an outline's edge (outline_smoother.hpp): one pixel wide on the side away from the mesh.
inline constexpr const char* kHemVertex = R"glsl(
layout(location = 0) in vec3 a_position;
layout(location = 1) in vec3 a_other;
layout(location = 2) in vec3 a_normal;
layout(location = 3) in vec3 a_colour;
layout(location = 4) in vec2 a_hem;
uniform mat4 u_clip_of_B;
uniform vec2 u_half_size_px;
out vec3 sky;
out vec3 sun;
out vec3 in_shadow_map;
out float cover;
void main() {
  vec4 here = u_clip_of_B * vec4(a_position, 1.0);
  vec4 there = u_clip_of_B * vec4(a_other, 1.0);
  // Direction of the edge on the screen; sign(w) keeps it correct if an end is behind the eye.
  vec2 along = (there.xy * here.w - here.xy * there.w) * u_half_size_px * sign(there.w);
  vec2 out_px = normalize(along + vec2(1e-9, 0.0)).yx * vec2(-1.0, 1.0) * a_hem.x;
  here.xy += a_hem.y * out_px / u_half_size_px * here.w;
  sky = a_colour * Sky(a_normal) * u_gain;
  sun = (a_colour * Sun(a_normal) + vec3(0.10 * Shine(a_position, a_normal))) * u_gain;
  in_shadow_map = InShadowMap(a_position, a_normal);
  cover = 1.0 - a_hem.y;
  gl_Position = here;
}
)glsl";

inline constexpr const char* kHemFragment = R"glsl(
in vec3 sky;
in vec3 sun;
in vec3 in_shadow_map;
in float cover;
out vec4 pixel;
void main() { pixel = vec4(sky + sun * Lit(in_shadow_map), cover); }
)glsl";

// A tile of a horizontal surface. Everything is linear in x and y of B, so only these two are interpolated.
inline constexpr const char* kPlaneVertex = R"glsl(
layout(location = 0) in vec2 a_low;  // the tile's corner
uniform vec2 u_tile_size;
uniform float u_z;
uniform mat4 u_clip_of_B;
out vec2 xy_B;
void main() {
  xy_B = a_low + u_tile_size * vec2(float(gl_VertexID & 1), float(gl_VertexID >> 1));
  gl_Position = u_clip_of_B * vec4(xy_B, u_z, 1.0);
}
)glsl";

// Run once: colour times light, with the shadows of static things.
inline constexpr const char* kPaintFragment = R"glsl(
in vec2 xy_B;
uniform sampler2D u_texture;
uniform vec4 u_uv_of_xy;  // offset, scale
uniform vec3 u_sky;
uniform vec3 u_sun;
uniform vec3 u_shadow_0;  // position in the shadow map: u_shadow_0 + x u_shadow_x + y u_shadow_y
uniform vec3 u_shadow_x;
uniform vec3 u_shadow_y;
out vec4 pixel;
void main() {
  vec3 colour = texture(u_texture, u_uv_of_xy.xy + u_uv_of_xy.zw * xy_B).rgb;
  pixel = vec4(colour * (u_sky + u_sun * Lit(u_shadow_0 + xy_B.x * u_shadow_x + xy_B.y * u_shadow_y)), 1.0);
}
)glsl";

// Per picture, tiles without a moving shadow: the painted surface.
inline constexpr const char* kLitPlaneFragment = R"glsl(
in vec2 xy_B;
uniform sampler2D u_texture;
uniform vec4 u_uv_of_xy;
uniform float u_gain;
out vec4 pixel;
void main() { pixel = vec4(texture(u_texture, u_uv_of_xy.xy + u_uv_of_xy.zw * xy_B).rgb * u_gain, 1.0); }
)glsl";

// Per picture, other tiles: adds the shadows of moving things, and the sky light that the target hides.
inline constexpr const char* kShadedPlaneFragment = R"glsl(
in vec2 xy_B;
uniform sampler2D u_texture;
uniform vec4 u_uv_of_xy;
uniform float u_gain;
uniform vec3 u_ball;      // the target: x, y in B, height of its centre over the plane
uniform float u_ball_r2;  // its radius squared
uniform float u_left;     // share of the light that a shadow leaves
uniform vec3 u_shadow_0;
uniform vec3 u_shadow_x;
uniform vec3 u_shadow_y;
out vec4 pixel;
void main() {
  vec3 to_ball = vec3(u_ball.xy - xy_B, u_ball.z);
  float near = inversesqrt(dot(to_ball, to_ball));
  float open = 1.0 - 0.8 * u_left * min(u_ball.z * near * near * near * u_ball_r2, 1.0);
  float lit = Lit(u_shadow_0 + xy_B.x * u_shadow_x + xy_B.y * u_shadow_y);
  vec3 colour = texture(u_texture, u_uv_of_xy.xy + u_uv_of_xy.zw * xy_B).rgb;
  pixel = vec4(colour * (u_gain * open * mix(u_left, 1.0, lit)), 1.0);
}
)glsl";

inline constexpr const char* kShadowVertex = R"glsl(
layout(location = 0) in vec3 a_position;
uniform mat4 u_clip_of_B;
uniform mat4 u_B_of_mesh;
void main() { gl_Position = u_clip_of_B * (u_B_of_mesh * vec4(a_position, 1.0)); }
)glsl";

inline constexpr const char* kShadowFragment = R"glsl(
void main() {}
)glsl";

// For a sensor that exposes its rows one after the other: a preamble defines ROLLING. A target is then drawn
// where it is when the pixel's row is exposed; in the rows of one band it moves uniformly.
inline constexpr const char* kRows = R"glsl(
#ifdef ROLLING
uniform vec3 u_rows;   // of the sensor: focal length and principal point along v, middle row of the band [px]
uniform vec4 u_lens;   // Brown's k1, k2, p1, p2
uniform float u_k3;
// Rows from the band's middle to the image of an ideal point.
float Rows(vec2 xy) {
  float r2 = dot(xy, xy);
  float radial = 1.0 + r2 * (u_lens.x + r2 * (u_lens.y + r2 * u_k3));
  float y = xy.y * radial + u_lens.z * (r2 + 2.0 * xy.y * xy.y) + 2.0 * u_lens.w * xy.x * xy.y;
  return u_rows.x * y + u_rows.y - u_rows.z;
}
#endif
)glsl";

// A ball is drawn on a rectangle around its outline, pixel by pixel. A ray d is tangent to the ball if
// |d x c| = R |d|. The first-order distance to this outline in pixels gives the covered share of the pixel.
inline constexpr const char* kBallVertex = R"glsl(
uniform vec4 u_rectangle;  // in normalised image coordinates: x min, y min, x max, y max
uniform mat4 u_clip_of_C;
out vec2 xy;
void main() {
  xy = vec2((gl_VertexID & 1) == 0 ? u_rectangle.x : u_rectangle.z,
            (gl_VertexID & 2) == 0 ? u_rectangle.y : u_rectangle.w);
  gl_Position = u_clip_of_C * vec4(xy, 1.0, 1.0);
}
)glsl";

inline constexpr const char* kBallFragment = R"glsl(
in vec2 xy;
uniform vec4 u_ball_C;      // centre and radius
uniform vec3 u_colour;
uniform float u_f_px;
uniform mat4 u_B_of_C;
uniform vec2 u_depth;       // z of the depth buffer = u_depth.x + u_depth.y / Z
#ifdef ROLLING
uniform vec3 u_centre_rate;  // motion of the centre from row to row
#endif
out vec4 pixel;
void main() {
  vec3 d = vec3(xy, 1.0);
  vec3 c = u_ball_C.xyz;
#ifdef ROLLING
  c += Rows(xy) * u_centre_rate;
#endif
  float R2 = u_ball_C.w * u_ball_C.w;
  vec3 m = cross(d, c);
  float d2 = dot(d, d);
  float inside = R2 * d2 - dot(m, m);  // above 0 if the ray meets the ball
  // Its slope along x and y of the image: d/dd (R2 d.d - |d x c|^2) = 2 (R2 d - c x (d x c)).
  vec2 slope = 2.0 * (R2 * d - cross(c, m)).xy;
#ifdef ROLLING
  slope.y -= 2.0 * u_rows.x * dot(cross(m, d), u_centre_rate);
#endif
  float per_px = u_f_px * inversesqrt(dot(slope, slope));
  float cover = clamp(inside * per_px + 0.5, 0.0, 1.0);
  if (cover <= 0.0) discard;
  // A partly covered pixel gets the mean brightness of its covered part. The normal's component towards the
  // eye grows with the root of the depth; over 0 to w, it takes its mean value at 4/9 w.
  inside = max(inside, 4.0 / 9.0 * cover / per_px);
  float t = (dot(d, c) - sqrt(inside)) / d2;
  vec3 p_C = t * d;
  vec3 n_C = normalize(p_C - c);
  vec3 p = (u_B_of_C * vec4(p_C, 1.0)).xyz;
  vec3 n_B = mat3(u_B_of_C) * n_C;
  vec3 sun = u_colour * Sun(n_B) + vec3(0.30 * Shine(p, n_B));
  pixel = vec4((u_colour * Sky(n_B) + sun * Lit(InShadowMap(p, n_B))) * u_gain, cover);
  gl_FragDepth = u_depth.x + u_depth.y / p_C.z;
}
)glsl";

// A flat plate, drawn on a rectangle like the ball. A polygon uses the lines of its edges in the image. A
// disc uses the cone of rays to its rim: |(n.p) d - (n.d) p| = R |n.d|, with normal n and centre p. Both use
// the distance to the outline in pixels, to first order.
inline constexpr const char* kPlateFragment = R"glsl(
in vec2 xy;
uniform vec3 u_normal_C;   // into the plate
uniform vec3 u_centre_C;
uniform float u_radius;    // for a disc
uniform int u_num_edges;   // 0: a disc
uniform vec3 u_edges[4];   // distance inside = edge . (x, y, 1), in the normalised image
uniform vec3 u_colour;
uniform float u_f_px;
uniform mat4 u_B_of_C;
uniform vec2 u_depth;
#ifdef ROLLING
uniform vec3 u_normal_rate;  // their changes from row to row
uniform vec3 u_centre_rate;
uniform vec3 u_edge_rates[4];
#endif
out vec4 pixel;
void main() {
  vec3 d = vec3(xy, 1.0);
  vec3 n = u_normal_C;
  vec3 p = u_centre_C;
#ifdef ROLLING
  float rows = Rows(xy);
  n += rows * u_normal_rate;
  p += rows * u_centre_rate;
#endif
  float to_plane = dot(n, p);
  float slant = dot(n, d);
  float cover = 1.0;
  if (u_num_edges == 0) {
    vec3 m = to_plane * d - slant * p;
    float inside = u_radius * u_radius * slant * slant - dot(m, m);
    vec2 slope = 2.0 * (u_radius * u_radius * slant * n - to_plane * m + dot(p, m) * n).xy;
#ifdef ROLLING
    float slant_rate = dot(u_normal_rate, d);
    vec3 m_rate = (dot(u_normal_rate, p) + dot(n, u_centre_rate)) * d - slant_rate * p - slant * u_centre_rate;
    slope.y += 2.0 * u_rows.x * (u_radius * u_radius * slant * slant_rate - dot(m, m_rate));
#endif
    cover = clamp(inside * u_f_px * inversesqrt(dot(slope, slope)) + 0.5, 0.0, 1.0);
  }
  for (int i = 0; i < u_num_edges; ++i) {
#ifdef ROLLING
    vec3 edge = u_edges[i] + rows * u_edge_rates[i];
    vec2 across = edge.xy + vec2(0.0, u_rows.x * dot(u_edge_rates[i], d));
    cover *= clamp(dot(edge, d) * u_f_px * inversesqrt(dot(across, across)) + 0.5, 0.0, 1.0);
#else
    cover *= clamp(dot(u_edges[i], d) * u_f_px + 0.5, 0.0, 1.0);
#endif
  }
  if (cover <= 0.0) discard;
  vec3 p_C = (to_plane / slant) * d;
  vec3 p_B = (u_B_of_C * vec4(p_C, 1.0)).xyz;
  vec3 n_B = mat3(u_B_of_C) * -n;
  pixel = vec4(u_colour * (Sky(n_B) + Sun(n_B) * Lit(InShadowMap(p_B, n_B))) * u_gain, cover);
  gl_FragDepth = u_depth.x + u_depth.y / p_C.z;
}
)glsl";

}  // namespace fovea::sim::shaders
