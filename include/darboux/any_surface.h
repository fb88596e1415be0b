/// \file any_surface.h
/// A surface chosen at run time: one of the catalogue by name, or a user's own type.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <darboux/evaluate.h>
#include <darboux/surface.h>
#include <darboux/testing.h>

namespace darboux {

/// A parameter with its value, as tables and JSON show it.
struct ParameterValue {
  std::string_view name;
  double value, default_value;
  Range permitted;
  std::string_view meaning;
};

/// Holds any surface type over double, by value (shared and immutable). One virtual call an evaluation.
class AnySurface {
 public:
  /// Any type that fulfils ParametricSurface, in the catalogue or not.
  /// \throws ParameterError when a parameter is out of its range
  template <ParametricSurface X>
  AnySurface(const X& surface) : held_(std::make_shared<Model<X>>(checked(surface))) {}  // NOLINT: converting

  const SurfaceInfo& info() const { return held_->info(); }
  std::vector<ParameterValue> parameters() const { return held_->parameters(); }
  Jet2<double> jet(double u, double v) const { return held_->jet(u, v); }
  Frame<double> frame(double u, double v) const { return held_->frame(u, v); }
  ParametricFrame<double> parametric_frame(double u, double v) const { return held_->parametric_frame(u, v); }
  Sample<double> sample(double u, double v) const { return held_->sample(u, v); }
  /// The independent facts the type states: "implicit", "gaussian_curvature".
  std::vector<std::string_view> facts() const { return held_->facts(); }
  /// Every law of testing.h on this surface.
  std::vector<Check> check(const CheckOptions& options) const { return held_->check(options); }
  /// The held object when it is an X, else null.
  template <class X>
  const X* get() const {
    const auto* model = dynamic_cast<const Model<X>*>(held_.get());
    return model ? &model->surface : nullptr;
  }

  /// "torus:major_radius=1,minor_radius=0.4": the name with all parameters, so that make_surface gives the same bits.
  /// \param digits significant digits for reading by people; 0: as many as it takes
  std::string specification(int digits = 0) const;

 private:
  struct Concept {
    virtual ~Concept() = default;
    virtual const SurfaceInfo& info() const = 0;
    virtual std::vector<ParameterValue> parameters() const = 0;
    virtual Jet2<double> jet(double u, double v) const = 0;
    virtual Frame<double> frame(double u, double v) const = 0;
    virtual ParametricFrame<double> parametric_frame(double u, double v) const = 0;
    virtual Sample<double> sample(double u, double v) const = 0;
    virtual std::vector<std::string_view> facts() const = 0;
    virtual std::vector<Check> check(const CheckOptions& options) const = 0;
  };
  template <class X>
  struct Model final : Concept {
    explicit Model(const X& s) : surface(s) {}
    const SurfaceInfo& info() const override { return X::info; }
    std::vector<ParameterValue> parameters() const override {
      std::vector<ParameterValue> result;
      for_each_parameter<X>([&](const auto& p) {
        result.push_back({p.name, p.of(surface), p.of(X{}), p.permitted, p.meaning});
      });
      return result;
    }
    Jet2<double> jet(double u, double v) const override { return darboux::jet(surface, u, v); }
    Frame<double> frame(double u, double v) const override { return darboux::frame(surface, u, v); }
    ParametricFrame<double> parametric_frame(double u, double v) const override {
      return darboux::parametric_frame(surface, u, v);
    }
    Sample<double> sample(double u, double v) const override { return darboux::sample(surface, u, v); }
    std::vector<std::string_view> facts() const override {
      std::vector<std::string_view> result;
      if constexpr (StatesImplicit<X>) result.push_back("implicit");
      if constexpr (StatesGaussianCurvature<X>) result.push_back("gaussian_curvature");
      return result;
    }
    std::vector<Check> check(const CheckOptions& options) const override {
      return check_surface(surface, options);
    }
    X surface;
  };
  std::shared_ptr<const Concept> held_;
};

/// Values for some parameters of a kind of surface, as written after its name.
struct SurfaceSpecification {
  std::string name;
  std::vector<std::pair<std::string, double>> parameters;
};

/// Parses "name" or "name:parameter=value,parameter=value". The name is known, the parameters are the
/// surface's, each once.
/// \throws ParameterError listing the known names or parameters
SurfaceSpecification parse_specification(std::string_view text);

/// The catalogue's surface of that name with those parameters, the others at their defaults.
/// \throws ParameterError for an unknown name or parameter (the known ones are listed) or a value out of
/// range
AnySurface make_surface(const SurfaceSpecification& specification);
AnySurface make_surface(std::string_view text);

/// Every surface of the catalogue with default parameters, in the catalogue's order.
const std::vector<AnySurface>& all_surfaces();

}  // namespace darboux
