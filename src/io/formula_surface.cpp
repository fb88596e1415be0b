// Surfaces from a user's formula. Its instructions run over every scalar type, so dual numbers give the
// partials.
#include <algorithm>
#include <cmath>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <darboux/adaptor.h>
#include <darboux/error.h>
#include <darboux/io.h>

#include "base/text.h"
#include "formula.h"
#include "formula_run.h"

namespace darboux {
namespace {

using io::formula::Definition;
using io::formula::execute;
using io::formula::first_definition;
using io::formula::Program;

// The type behind read_formula_surface(); T is the scalar of the parameters.
template <class T = double>
class FormulaSurface {
 public:
  static constexpr SurfaceInfo info{"formula", "a formula from a file", Coordinate::linear,
                                    Coordinate::linear};

  FormulaSurface(std::shared_ptr<const Program> program, std::vector<T> values)
      : program_(std::move(program)), values_(std::move(values)) {}

  template <class S>
  Jet2<S> jet(const S& u, const S& v) const {
    Jet2<S> j = detail::jet_by_duals<info.u, info.v, S>(
        [this](const auto& a, const auto& b) { return this->position(a, b); }, u, v);
    // Where there is no position there are no partials, although the differentiation rules give log a slope
    // left of zero.
    for (S Vec3<S>::*const c : {&Vec3<S>::x, &Vec3<S>::y, &Vec3<S>::z})
      if (const S& p = j.position.*c; !(p == p))
        for (Vec3<S>* partial : {&j.dpdu, &j.dpdv, &j.d2pdu2, &j.d2pduv, &j.d2pdv2}) partial->*c = p;
    return j;
  }

  template <class S>
  Vec3<S> position(const S& u, const S& v) const {
    std::vector<S> variables(first_definition + program_->definitions.size());
    variables[0] = u;
    variables[1] = v;
    variables[2] = pi<S>();
    for (std::size_t k = 0; k < values_.size(); ++k)
      variables[first_definition + static_cast<std::size_t>(program_->parameters[k])] = lift<S>(values_[k]);
    std::vector<S> stack;
    for (const int d : program_->order)
      variables[static_cast<std::size_t>(first_definition + d)] =
          execute(program_->definitions[static_cast<std::size_t>(d)].code, variables, stack);
    const auto of = [&](int k) { return variables[static_cast<std::size_t>(k)]; };
    return {of(program_->position[0]), of(program_->position[1]), of(program_->position[2])};
  }

  std::vector<ParameterValue> parameter_values() const {
    std::vector<ParameterValue> result;
    for (std::size_t k = 0; k < values_.size(); ++k) {
      const Definition& d = program_->definitions[static_cast<std::size_t>(program_->parameters[k])];
      // The domain of the formula is unknown, so random parameters stay within a factor of two.
      const double standard = program_->standard[k], size = standard == 0 ? 1 : std::fabs(standard);
      result.push_back(
          {d.name, static_cast<double>(values_[k]), standard, Range{}, d.meaning, {size / 2, size * 2}});
    }
    return result;
  }
  template <class From>
  void set_parameters(std::span<const From> values) {
    for (std::size_t k = 0; k < std::min(values.size(), values_.size()); ++k)
      values_[k] = static_cast<T>(values[k]);
  }

  std::string refusal() const {
    for (const ParameterValue& p : parameter_values())
      if (!std::isfinite(p.value))
        return std::string(p.name) + ": " + expected_got("a finite number", shortest(p.value));
    return {};
  }

  template <class To>
  auto rebind() const {
    std::vector<To> values;
    for (const T& x : values_) values.push_back(lift<To>(x));
    return FormulaSurface<To>(program_, std::move(values));
  }

 private:
  std::shared_ptr<const Program> program_;
  std::vector<T> values_;
};

}  // namespace

AnySurface read_formula_surface(const std::string& path,
                                const std::vector<std::pair<std::string, double>>& parameters) {
  const auto program = std::make_shared<const Program>(io::formula::read_program(path));
  std::vector<double> values = program->standard;
  for (const auto& [name, value] : parameters) {
    const auto is_it = [&, &wanted = name](int d) {
      return program->definitions[static_cast<std::size_t>(d)].name == wanted;
    };
    const auto found = std::find_if(program->parameters.begin(), program->parameters.end(), is_it);
    if (found == program->parameters.end()) {
      std::string known;
      for (const int d : program->parameters)
        known += (known.empty() ? "" : ", ") + program->definitions[static_cast<std::size_t>(d)].name;
      throw ParameterError("formula " + path, "unknown parameter '" + name + "', known are " +
                                                  (known.empty() ? "none" : known) +
                                                  " (names defined by numbers alone)");
    }
    values[static_cast<std::size_t>(found - program->parameters.begin())] = value;
  }
  return AnySurface(FormulaSurface<double>(program, values)).from_file(path);
}

}  // namespace darboux
