/// \file lanes.h
/// The interface between lanes_dispatch.cpp, which knows the mesh, and lanes.cpp, which is compiled once per
/// instruction set and handles four or more triangles or corners at a time. Plain data only: nothing here may
/// compile differently in the two.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include <darboux/vector.h>

namespace darboux::mikk {

using Vector = Vec3<float>;
using Index = std::uint32_t;

// The orientation of a triangle that is not degenerate.
struct Orientation {
  std::uint8_t preserves : 1;  // the uvs wind as the triangle does
  std::uint8_t any : 1;  // joins groups of either orientation: its uvs lack area, or s or t lacks length
};
// Unit directions of increasing u and v in a triangle, and at each corner the angle between its edges,
// projected along the normal there.
struct Directions {
  Vector s, t;
  std::array<float, 3> angle;
};
// A corner's contribution: the directions, unit and perpendicular to the normal there, to be weighted by the
// angle. The angle is stored next to each of them, so that four numbers are stored and loaded at a time.
struct Part {
  Vector s;
  float angle;
  Vector t;
  float same_angle;
};
// Lanes are stored over several members at once.
static_assert(sizeof(Directions) == 36 && offsetof(Directions, t) == 12 && offsetof(Directions, angle) == 24);
static_assert(sizeof(Part) == 32 && offsetof(Part, angle) == 12 && offsetof(Part, t) == 16);
// Lengths of the derivatives in u and v.
struct Lengths {
  float s, t;
};

// Some triangles.
struct Triangles {
  const float *positions, *normals, *uvs;  // of vertices
  Index last_vertex;
  const Index* vertices;  // three per triangle
  std::size_t count;
  bool scale;                         // triangle by triangle, by powers of two, to about 1
  bool shrink_positions, shrink_uvs;  // by a quarter first
  float (*arc_cosine)(float x);       // for when lanes cannot decide between two floats
  Directions* directions;
  Orientation* orientation;
  Lengths* lengths;  // null: not wanted
};

// The corners about a vertex that has few: the vertices before and after each in its triangle, and the places
// of the corners that are reached across the edges from there and to there.
struct Ring {
  static constexpr std::size_t most = 16;
  static constexpr Index none = ~Index{0};
  std::size_t count;
  std::array<Index, most> next, previous;  // beyond count: of no vertex, and other than each other
  std::array<Index, most> after, before;   // of which `after` passes the edge to `next`; or none
};

// A vertex whose corners form one group.
struct Group {
  const Index* corners;
  std::size_t count;
  Index vertex;  // its normal is used
};
struct Groups {
  const Directions* directions;
  const float* normals;
  Index last_vertex;
  const Group* groups;
  std::size_t count;
};
// The average of a group's parts: unit(sum angle s). `near` if s and t of all parts are so near those of the
// first that an angular threshold of 180 degrees would keep them together.
struct Average {
  Vector s;
  float near;  // 1, else 0
};
static_assert(sizeof(Average) == 16);

// The kernels of one instruction set. All sets give the same bits.
struct LaneKernels {
  // Whether one of the triangles is `any`.
  bool (*differentiate)(const Triangles& triangles);
  // The parts of corners 3 t + k at a vertex with this normal. Room for parts is a multiple of
  // parts_at_once.
  void (*find_parts)(const Directions* directions, const Index* corners, std::size_t count,
                     const float* normal, Part* parts);
  // `after` and `before` of some rings. Where an edge is passed more than twice, each of these is any of
  // those that fit, and links there and back may disagree.
  void (*link)(Ring* rings, std::size_t count);
  // For groups without triangles that are `any`.
  void (*average)(const Groups& groups, Average* averages);
  // acos as differentiate() takes it, for its test; `exactly` is Triangles::arc_cosine. \param count a
  // multiple of 16
  void (*arc_cosines)(const float* cosines, std::size_t count, float (*exactly)(float x), float* angles);
};
constexpr std::size_t parts_at_once = 8;

}  // namespace darboux::mikk
