// One run of a program: registers, where it runs, and the operations that vm.cpp dispatches to.
// Each takes the operands of its instruction, `w`, which check_program() has found sound.
#pragma once

#include <optional>

#include "bsdf/bsdf.h"
#include "scene/scene.h"
#include "shading/ops.h"
#include "textures/noise.h"

namespace photon_splat::nodes {

// Two directions along the surface, of a pixel's width there, m.
struct OffsetAxes {
  Vec3 x, y;
};

// Generated coordinates of meshes that deform, where the exporter gives them
inline constexpr uint32_t kGeneratedAttribute = 0;
// Positions, in the mesh's coordinates, before true displacement: of meshes whose bumps ask for
// them
inline constexpr uint32_t kUndisplacedAttribute = 1;

struct Frame {
  const Scene& scene;
  const Program& program;
  const ShadingPoint& point;
  Bsdf& out;
  float* registers;
  const float* constants;
  NoiseQueue& noise;
  // Where Offset has moved the point to, until the next one.
  Vec3 shift{};
  Vec2 shifted_uv{};  // barycentric; see uv_there()
  bool knows_uv = false, knows_axes = false, knows_object_normal = false;
  // Positions are those before displacement, see Offset: then it is here, relative to the scene's
  // origin
  bool before = false;
  Vec3 position_before{};
  Vec3 ns = point.ns;   // bent where BentNormal has done so
  Vec3 displacement{};  // what Displace gave
  OffsetAxes axes{};
  Vec3 normal_in_object{};
  // The pose of a moving instance at the time of the ray
  std::optional<Pose> pose = pose_now();

  const float* at(uint32_t word) const {
    return (word & kConstant ? constants : registers) + (word & ~kConstant);
  }
  float number(uint32_t word) const { return *at(word); }
  Vec3 vector(uint32_t word) const {
    const float* p = at(word);
    return {p[0], p[1], p[2]};
  }
  void set(uint32_t word, float value) {
    if (word != kUnused) registers[word] = value;
  }
  void set(uint32_t word, const Vec3& value) {
    if (word == kUnused) return;
    float* p = registers + word;
    p[0] = value.x;
    p[1] = value.y;
    p[2] = value.z;
  }
  template <class Mode>
  static Mode mode(uint32_t word) {
    return static_cast<Mode>(word);
  }
  static bool on(uint32_t word) { return word == static_cast<uint32_t>(Switch::ON); }

  // Defined in surface.cpp: what is known of the hit
  bool is_on_mesh() const { return point.instance != ShadingPoint::kNoInstance; }
  bool is_on_surface() const { return is_on_mesh() && !point.medium; }
  bool is_background() const { return !is_on_mesh() && !point.lamp && !point.medium; }
  Vec3 normal() const { return is_background() ? point.wo : ns; }
  // Relative to the scene's origin, shifted. From the triangle's corners: a ray's own end has an
  // error that grows with its length, and shows where patterns change along a surface
  Vec3 place() const;
  Vec3 position() const;                         // absolute, shifted; background: the direction
  Vec3 object_position() const;                  // in the object's coordinates, shifted
  Vec3 normal_to_object(const Vec3& n) const;    // unit
  const Vec3& object_normal();                   // normal() in the object's coordinates
  Vec3 normal_from_object(const Vec3& n) const;  // unit
  // Position before displacement, relative to the scene's origin, at barycentric coordinates
  Vec3 undisplaced(const MeshAttribute& positions, const Vec2& at) const;
  Vec3 generated();
  const Mesh& mesh() const { return scene.meshes[scene.instances[point.instance].mesh]; }
  const Strands* strands() const { return is_on_surface() ? mesh().strands.get() : nullptr; }
  std::optional<Pose> pose_now() const;
  const Affine& world_to_object() const;  // from coordinates relative to the scene's origin
  Affine object_to_world() const;         // to coordinates relative to the scene's origin
  // An attribute of the mesh at the shifted point; false where the mesh has none.
  bool attribute(uint32_t id, std::array<float, 4>& value, uint32_t& components);
  Vec3 uv(uint32_t id);  // kNone: the render-active UV map

  // normals.cpp
  void corners(Vec3* corner) const;  // of the triangle, relative to the scene's origin
  const OffsetAxes& offset_axes();
  Vec2 uv_there();  // barycentric coordinates of the shifted point
};

// strands.cpp: of the strand that the point is on, if any
HairFrame hair_frame(const Frame& f, const Vec3& tangent);  // tangent 0: its own
Vec3 strand_tangent(const Frame& f);                        // of any length; 0: none
// Along the major axis of a curve's cross-section, of a direction in the object's coordinates; 0:
// of surfaces
Vec3 strand_axis(const Frame& f, const Vec3& in_object, const Vec3& tangent);
// Half a camera sample's width over the strand's radius, where a camera path meets a curve; else 1
float strand_coverage(const Frame& f);
void curves_info(Frame& f, const uint32_t* w);
void point_info(Frame& f, const uint32_t* w);

// surface.cpp
void geometry(Frame& f, const uint32_t* w);
void texture_coordinate(Frame& f, const uint32_t* w);
void uv_map(Frame& f, const uint32_t* w);
void mesh_attribute(Frame& f, const uint32_t* w);
void instance_attribute(Frame& f, const uint32_t* w);
void object_location(Frame& f, const uint32_t* w);
void camera_data(Frame& f, const uint32_t* w);
void light_path(Frame& f, const uint32_t* w);
void light_falloff(Frame& f, const uint32_t* w);
void wireframe(Frame& f, const uint32_t* w);
void fresnel(Frame& f, const uint32_t* w);
void layer_weight(Frame& f, const uint32_t* w);
void vector_transform(Frame& f, const uint32_t* w);

// traced.cpp
void ambient_occlusion(Frame& f, const uint32_t* w);
void bevel(Frame& f, const uint32_t* w);
void raycast(Frame& f, const uint32_t* w);

// normals.cpp
void tangent_radial(Frame& f, const uint32_t* w);
void tangent_uv(Frame& f, const uint32_t* w);
void normal_map(Frame& f, const uint32_t* w);
void offset(Frame& f, const uint32_t* w);
void bump(Frame& f, const uint32_t* w);
void vector_displacement(Frame& f, const uint32_t* w);
void displacement_bump(Frame& f, const uint32_t* w);

// arithmetic.cpp
void math(Frame& f, const uint32_t* w);
void vector_math(Frame& f, const uint32_t* w);
void map_range(Frame& f, const uint32_t* w);
void map_range_vector(Frame& f, const uint32_t* w);
void clamp(Frame& f, const uint32_t* w);
void color_ramp(Frame& f, const uint32_t* w);
void float_curve(Frame& f, const uint32_t* w);
void curves(Frame& f, const uint32_t* w);
void vector_rotate(Frame& f, const uint32_t* w);
void mapping(Frame& f, const uint32_t* w);
void transform_point(Frame& f, const uint32_t* w);

// color.cpp
void mix_color(Frame& f, const uint32_t* w);
void hue_saturation(Frame& f, const uint32_t* w);
void bright_contrast(Frame& f, const uint32_t* w);
void gamma(Frame& f, const uint32_t* w);
void separate_color(Frame& f, const uint32_t* w);
void combine_color(Frame& f, const uint32_t* w);
void blackbody(Frame& f, const uint32_t* w);
void wavelength(Frame& f, const uint32_t* w);

// image.cpp
void image_texture(Frame& f, const uint32_t* w);
void environment_texture(Frame& f, const uint32_t* w);
void sun_disc(Frame& f, const uint32_t* w);
void ies_texture(Frame& f, const uint32_t* w);

// noise.cpp, voronoi.cpp, gabor.cpp, patterns.cpp
void noise_texture(Frame& f, const uint32_t* w);
void voronoi_texture(Frame& f, const uint32_t* w);
void gabor_texture(Frame& f, const uint32_t* w);
void wave_texture(Frame& f, const uint32_t* w);
void magic_texture(Frame& f, const uint32_t* w);
void checker_texture(Frame& f, const uint32_t* w);
void brick_texture(Frame& f, const uint32_t* w);
void gradient_texture(Frame& f, const uint32_t* w);
void white_noise_texture(Frame& f, const uint32_t* w);

// closures.cpp: BentNormal, and Emission to Principled
void bent_normal(Frame& f, const uint32_t* w);
void closure(Frame& f, Op op, const uint32_t* w);
// Within what a chain of lobes can multiply without leaving the range of floats; what is not a
// number is 0.
inline constexpr float kMostScattered = 1e6f;
inline float bounded(float x, float most) { return x == x ? std::clamp(x, -most, most) : 0; }
inline Rgb bounded(const Rgb& c, float most) {
  return {bounded(c.x, most), bounded(c.y, most), bounded(c.z, most)};
}
// Nodes have normals on the side that is looked at, closures on the surface's front. Without
// length: the shading normal.
inline Vec3 front_normal(const Frame& f, uint32_t word) {
  Vec3 n = f.vector(word);
  const float l = length(n);
  n = l > 0 && std::isfinite(l) ? n / l : f.normal();
  return f.point.back ? -n : n;
}

// hair_closures.cpp
void hair(Frame& f, const Rgb& weight, const uint32_t* w);
void principled_hair(Frame& f, const uint32_t* w);
// media.cpp: GridValue; VolumeAbsorption to PrincipledVolume
void grid_value(Frame& f, const uint32_t* w);
void medium_closure(Frame& f, Op op, const uint32_t* w);

// Helpers of several of these.
inline Vec3 safe_normalize(const Vec3& v) {
  const float l = length(v);
  return l != 0 ? v * (1.0f / l) : v;
}
inline float clamp_unit(float x) { return std::min(std::max(x, 0.0f), 1.0f); }
inline Vec3 clamp_unit(const Vec3& v) {
  return {clamp_unit(v.x), clamp_unit(v.y), clamp_unit(v.z)};
}
inline float safe_divide(float a, float b) { return b != 0 ? a / b : 0; }
inline Vec3 safe_divide(const Vec3& a, const Vec3& b) {
  return {safe_divide(a.x, b.x), safe_divide(a.y, b.y), safe_divide(a.z, b.z)};
}
inline float mix(float a, float b, float t) { return a * (1 - t) + b * t; }
inline Vec3 mix(const Vec3& a, const Vec3& b, float t) { return a * (1 - t) + b * t; }
// Whole part for any float: NaN is 0, what does not fit the nearest that does.
inline int32_t to_int(float x) {
  return x == x ? static_cast<int32_t>(std::clamp(x, -2147483648.0f, 2147483520.0f)) : 0;
}
template <class F>
Vec3 each(const Vec3& a, F&& f) {
  return {f(a.x), f(a.y), f(a.z)};
}
template <class F>
Vec3 each(const Vec3& a, const Vec3& b, F&& f) {
  return {f(a.x, b.x), f(a.y, b.y), f(a.z, b.z)};
}

}  // namespace photon_splat::nodes
