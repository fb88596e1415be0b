/// \file packed.h
/// Serialises the content of a file, to pass it from one process to another.
#pragma once

#include <cstring>
#include <stdexcept>
#include <string>
#include <string_view>

#include <darboux/io.h>

#include "child.h"

namespace darboux::io {

/// Appends every visited value.
struct Pack {
  std::string bytes;

  template <class T>
  void flat(T& value) {
    bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
  }
  template <class List>  // of flat values
  void list(List& values) {
    std::size_t count = values.size();
    flat(count);
    bytes.append(reinterpret_cast<const char*>(values.data()), count * sizeof values[0]);
  }
  template <class List, class F>
  void each(List& values, F f) {
    std::size_t count = values.size();
    flat(count);
    for (auto& value : values) f(value);
  }
};

/// Fills in every visited value from bytes made by Pack. \throws ChildFailure if they end early
struct Unpack {
  std::string_view bytes;

  template <class T>
  void flat(T& value) {
    take(&value, sizeof value);
  }
  template <class List>
  void list(List& values) {
    values.resize(count(sizeof values[0]));
    take(values.data(), values.size() * sizeof values[0]);
  }
  template <class List, class F>
  void each(List& values, F f) {
    values.resize(count(1));
    for (auto& value : values) f(value);
  }

 private:
  void take(void* to, std::size_t size) {
    if (size > bytes.size()) throw ChildFailure("gives half an answer");
    if (size > 0) std::memcpy(to, bytes.data(), size);  // an empty list has no address
    bytes.remove_prefix(size);
  }
  std::size_t count(std::size_t size_of_each) {
    std::size_t result = 0;
    flat(result);
    if (result > bytes.size() / size_of_each) throw ChildFailure("gives half an answer");
    return result;
  }
};

template <class Visitor>
void visit(Visitor& v, std::string& refusal, Asset& asset) {
  v.list(refusal);
  v.each(asset.primitives, [&](Primitive& p) {
    v.flat(p.mesh);
    v.flat(p.primitive);
    v.list(p.name);
    v.flat(p.texcoord);
    v.list(p.data.positions);
    v.list(p.data.normals);
    v.list(p.data.uvs);
    v.list(p.data.tangents);
    v.list(p.data.triangles);
    v.each(p.other_uvs, [&](auto& set) {
      v.flat(set.first);
      v.list(set.second);
    });
    std::vector<Eigen::Matrix4d> instances(p.instances.begin(), p.instances.end());
    v.list(instances);
    p.instances = std::move(instances);
  });
  v.each(asset.skipped, [&](SkippedPrimitive& s) {
    v.flat(s.mesh);
    v.list(s.reason);
  });
}

}  // namespace darboux::io
