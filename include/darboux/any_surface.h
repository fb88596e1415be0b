/// \file any_surface.h
/// Type-erased surfaces, chosen at run time: one of the catalogue by name, or a user-defined type.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <darboux/error.h>
#include <darboux/evaluate.h>
#include <darboux/multiprecision.h>
#include <darboux/surface.h>

namespace darboux {

/// A parameter with its value, as shown in tables and JSON.
struct ParameterValue {
  std::string_view name;
  double value, default_value;
  Range permitted;
  std::string_view meaning;
  Magnitudes proven;
};

/// A value and its derivatives with respect to u and v; nested, the second ones too.
using DualUV = Dual<double, 2>;
using NestedDualUV = Dual<DualUV, 2>;

/// A surface type whose parameters are known only at run time. Instead of parameters(), X has
///   std::vector<ParameterValue> parameter_values() const     the names live as long as the surface
///   void set_parameters(std::span<const T>)                   sets all of them, in that order; T is its
///                                                             scalar
template <class X>
concept HasParametersAtRunTime = requires(X& x, std::span<const double> values) {
  { std::as_const(x).parameter_values() } -> std::same_as<std::vector<ParameterValue>>;
  x.set_parameters(values);
};

namespace detail {

// Does not compile if the formula accepts double only.
template <class X>
constexpr void expect_dual_numbers() {
  constexpr bool any_scalar =
      requires(const X& x, const Prepared<X::info.u, DualUV>& u, const Prepared<X::info.v, DualUV>& v) {
    x.jet(u, v);
  };
  static_assert(
      any_scalar,
      "expected template <class S> jet(u, v) of any scalar S; got one that does not take dual numbers");
}

}  // namespace detail

/// Holds a surface of any type over double, by value (shared and immutable). Cost: one virtual call per
/// evaluation.
class AnySurface {
 public:
  /// Any type that satisfies ParametricSurface for every scalar named below, in the catalogue or not. \throws
  /// ParameterError if a parameter is out of range
  template <ParametricSurface X>
  AnySurface(const X& surface)  // NOLINT: converting
      : held_(std::make_shared<Model<X>>(checked(surface))) {
    detail::expect_dual_numbers<X>();
  }

  const SurfaceInfo& info() const { return held_->info(); }
  std::vector<ParameterValue> parameters() const { return held_->parameters(); }
  Jet2<double> jet(double u, double v) const { return held_->jet(u, v); }
  Jet2<DualUV> jet(const DualUV& u, const DualUV& v) const { return held_->jet(u, v); }
  Jet2<NestedDualUV> jet(const NestedDualUV& u, const NestedDualUV& v) const { return held_->jet(u, v); }
  /// The jet in 40 decimal digits, optionally with other values for all parameters (in the order of
  /// parameters()). \throws ParameterError if the number of values differs from the number of parameters
  Jet2<Multiprecision> jet(const Multiprecision& u, const Multiprecision& v,
                           std::span<const Multiprecision> values = {}) const {
    if (!values.empty()) expect_one_per_parameter(values.size());
    return held_->jet(u, v, values);
  }
  Frame<double> frame(double u, double v) const { return held_->frame(u, v); }
  /// frame(u, v).status, at the cost of frame().
  Status status(double u, double v) const { return frame(u, v).status; }
  ParametricFrame<double> parametric_frame(double u, double v) const { return held_->parametric_frame(u, v); }
  Sample<double> sample(double u, double v) const { return make_sample(u, v, jet(u, v), frame(u, v)); }
  /// The sample computed in single precision, with parameters rounded to float.
  Sample<float> sample_in_float(float u, float v) const { return held_->sample_in_float(u, v); }
  /// Evaluates many points at once: see evaluate() in evaluate.h.
  StatusSummary evaluate(const Points<double>& points, const Outputs<double>& outputs,
                         const EvaluateOptions& options = {}) const {
    return held_->evaluate(points, outputs, options);
  }
  StatusSummary evaluate(const Points<float>& points, const Outputs<float>& outputs,
                         const EvaluateOptions& options = {}) const {
    return held_->evaluate(points, outputs, options);
  }
  /// Curvatures from the jet and the frame at (u, v): see curvature() in curvature.h, which calls this.
  Curvature<double> curvature(double u, double v, const Jet2<double>& jet, const Frame<double>& frame) const {
    return held_->curvature(u, v, jet, frame);
  }
  bool has_closed_frame() const { return held_->has_closed_frame(); }

  /// The values of u (along = 0) or v (along = 1) at which the surface is only piecewise smooth: those
  /// strictly between 0 and 1, and also 0 if it is not smooth where 0 meets 1 (across the seam or the poles).
  /// Taken from breaks(along) of the type; empty if it has no such member.
  std::vector<double> breaks(int along) const { return held_->breaks(along); }

  /// The names of the independent facts that the type states: some of implicit, gaussian_curvature,
  /// mean_curvature, second_formula.
  std::vector<std::string_view> facts() const { return held_->facts(); }
  /// The values of these facts; empty if the type does not state the fact.
  std::optional<double> implicit(const Vec3<double>& p) const { return held_->implicit(p); }
  std::optional<Vec3<double>> implicit_gradient(const Vec3<double>& p) const {
    return held_->implicit_gradient(p);
  }
  std::optional<double> gaussian_curvature(double u, double v) const {
    return held_->gaussian_curvature(u, v);
  }
  std::optional<double> mean_curvature(double u, double v) const { return held_->mean_curvature(u, v); }
  std::optional<Vec3<double>> second_formula(double u, double v) const { return held_->second_formula(u, v); }

  /// The same surface with other values for all its parameters, in the order of parameters().
  /// \throws ParameterError if a value is out of range, or their number differs from that of the parameters
  AnySurface with(std::span<const double> values) const;

  /// The file this surface was read from (io.h); empty if none.
  const std::string& file() const { return file_; }
  AnySurface from_file(std::string path) const {
    AnySurface result = *this;
    result.file_ = std::move(path);
    return result;
  }

  /// The held surface if its type is X, else null.
  template <class X>
  const X* get() const {
    const auto* model = dynamic_cast<const Model<X>*>(held_.get());
    return model ? &model->surface : nullptr;
  }

  /// The surface as text: the name with all parameters, "torus:major_radius=1,minor_radius=0.4"; for a
  /// surface from a file, "formula:file=my.surface,a=3". make_surface() of this text reproduces the surface
  /// bit for bit if it is determined by its parameters or its file. It does not for surfaces with control
  /// points or curves (splines, tubes), whose text has the name and the parameters only; for adaptors, whose
  /// text is the name only ("offset torus"); and for types outside the catalogue. \param digits significant
  /// digits, for display; 0: as many as are needed to reproduce the bits
  std::string specification(int digits = 0) const;

 private:
  struct Concept {
    virtual ~Concept() = default;
    virtual const SurfaceInfo& info() const = 0;
    virtual std::vector<ParameterValue> parameters() const = 0;
    virtual Jet2<double> jet(double u, double v) const = 0;
    virtual Jet2<DualUV> jet(const DualUV& u, const DualUV& v) const = 0;
    virtual Jet2<NestedDualUV> jet(const NestedDualUV& u, const NestedDualUV& v) const = 0;
    virtual Jet2<Multiprecision> jet(const Multiprecision& u, const Multiprecision& v,
                                     std::span<const Multiprecision> values) const = 0;
    virtual Frame<double> frame(double u, double v) const = 0;
    virtual ParametricFrame<double> parametric_frame(double u, double v) const = 0;
    virtual Curvature<double> curvature(double u, double v, const Jet2<double>& jet,
                                        const Frame<double>& frame) const = 0;
    virtual Sample<float> sample_in_float(float u, float v) const = 0;
    virtual StatusSummary evaluate(const Points<double>& points, const Outputs<double>& outputs,
                                   const EvaluateOptions& options) const = 0;
    virtual StatusSummary evaluate(const Points<float>& points, const Outputs<float>& outputs,
                                   const EvaluateOptions& options) const = 0;
    virtual bool has_closed_frame() const = 0;
    virtual std::vector<double> breaks(int along) const = 0;
    virtual std::vector<std::string_view> facts() const = 0;
    virtual std::optional<double> implicit(const Vec3<double>& p) const = 0;
    virtual std::optional<Vec3<double>> implicit_gradient(const Vec3<double>& p) const = 0;
    virtual std::optional<double> gaussian_curvature(double u, double v) const = 0;
    virtual std::optional<double> mean_curvature(double u, double v) const = 0;
    virtual std::optional<Vec3<double>> second_formula(double u, double v) const = 0;
    virtual AnySurface with(std::span<const double> values) const = 0;
  };

  template <class X>
  struct Model final : Concept {
    explicit Model(const X& s) : surface(s) {}
    const SurfaceInfo& info() const override { return X::info; }
    std::vector<ParameterValue> parameters() const override {
      if constexpr (HasParametersAtRunTime<X>) {
        return surface.parameter_values();
      } else {
        std::vector<ParameterValue> result;
        for_each_parameter<X>([&, standard = X{}](const auto& p) {
          result.push_back({p.name, p.of(surface), p.of(standard), p.permitted, p.meaning, p.proven});
        });
        return result;
      }
    }
    Jet2<double> jet(double u, double v) const override { return darboux::jet(surface, u, v); }
    Jet2<DualUV> jet(const DualUV& u, const DualUV& v) const override { return darboux::jet(surface, u, v); }
    Jet2<NestedDualUV> jet(const NestedDualUV& u, const NestedDualUV& v) const override {
      return detail::jet_of(surface, u, v);
    }
    Jet2<Multiprecision> jet(const Multiprecision& u, const Multiprecision& v,
                             std::span<const Multiprecision> values) const override {
      auto many = rebind<Multiprecision>(surface);
      std::size_t k = 0;
      for_each_parameter<decltype(many)>([&](const auto& p) {
        using T = std::remove_cvref_t<decltype(p.of(many))>;
        if (k < values.size()) p.of(many) = static_cast<T>(values[k++]);
      });
      if constexpr (HasParametersAtRunTime<X>)
        if (!values.empty()) many.set_parameters(values);
      return darboux::jet(many, u, v);
    }
    Frame<double> frame(double u, double v) const override { return darboux::frame(surface, u, v); }
    ParametricFrame<double> parametric_frame(double u, double v) const override {
      return darboux::parametric_frame(surface, u, v);
    }
    Curvature<double> curvature(double u, double v, const Jet2<double>& jet,
                                const Frame<double>& frame) const override {
      return darboux::curvature(surface, u, v, jet, frame);
    }
    Sample<float> sample_in_float(float u, float v) const override {
      return darboux::sample(rebind<float>(surface), u, v);
    }
    StatusSummary evaluate(const Points<double>& points, const Outputs<double>& outputs,
                           const EvaluateOptions& options) const override {
      return darboux::evaluate(surface, points, outputs, options);
    }
    StatusSummary evaluate(const Points<float>& points, const Outputs<float>& outputs,
                           const EvaluateOptions& options) const override {
      return darboux::evaluate(surface, points, outputs, options);
    }
    bool has_closed_frame() const override { return HasClosedFrame<X>; }
    std::vector<double> breaks([[maybe_unused]] int along) const override {
      if constexpr (requires { surface.breaks(along); }) return surface.breaks(along);
      return {};
    }
    std::vector<std::string_view> facts() const override {
      std::vector<std::string_view> result;
      if constexpr (StatesImplicit<X>) result.push_back("implicit");
      if constexpr (StatesGaussianCurvature<X>) result.push_back("gaussian_curvature");
      if constexpr (StatesMeanCurvature<X>) result.push_back("mean_curvature");
      if constexpr (StatesSecondFormula<X>) result.push_back("second_formula");
      return result;
    }
    std::optional<double> implicit([[maybe_unused]] const Vec3<double>& p) const override {
      if constexpr (StatesImplicit<X>) return surface.implicit(p);
      return std::nullopt;
    }
    std::optional<Vec3<double>> implicit_gradient([[maybe_unused]] const Vec3<double>& p) const override {
      if constexpr (StatesImplicit<X>) {
        using D = Dual<double, 3>;
        const D d = surface.implicit(Vec3<D>{D::variable(p.x, 0), D::variable(p.y, 1), D::variable(p.z, 2)});
        return Vec3<double>{d.derivative[0], d.derivative[1], d.derivative[2]};
      }
      return std::nullopt;
    }
    std::optional<double> gaussian_curvature([[maybe_unused]] double u,
                                             [[maybe_unused]] double v) const override {
      if constexpr (StatesGaussianCurvature<X>)
        return surface.gaussian_curvature(prepare<X::info.u>(u), prepare<X::info.v>(v));
      return std::nullopt;
    }
    std::optional<double> mean_curvature([[maybe_unused]] double u,
                                         [[maybe_unused]] double v) const override {
      if constexpr (StatesMeanCurvature<X>)
        return surface.mean_curvature(prepare<X::info.u>(u), prepare<X::info.v>(v));
      return std::nullopt;
    }
    std::optional<Vec3<double>> second_formula([[maybe_unused]] double u,
                                               [[maybe_unused]] double v) const override {
      if constexpr (StatesSecondFormula<X>)
        return surface.second_formula(prepare<X::info.u>(u), prepare<X::info.v>(v));
      return std::nullopt;
    }
    AnySurface with(std::span<const double> values) const override {
      X changed = surface;
      std::size_t k = 0;
      for_each_parameter<X>([&](const auto& p) {
        if (k < values.size()) p.of(changed) = values[k++];
      });
      if constexpr (HasParametersAtRunTime<X>) changed.set_parameters(values);
      return AnySurface(changed);
    }
    X surface;
  };
  void expect_one_per_parameter(std::size_t values) const;

  std::shared_ptr<const Concept> held_;
  std::string file_;
};

/// evaluate() of evaluate.h for a type-erased surface.
template <std::floating_point T>
StatusSummary evaluate(const AnySurface& surface, const Points<T>& points, const Outputs<T>& outputs,
                       const EvaluateOptions& options = {}) {
  return surface.evaluate(points, outputs, options);
}

/// The name of a surface, and values for some of its parameters.
struct SurfaceSpecification {
  std::string name;
  std::vector<std::pair<std::string, double>> parameters;
};

/// Parses "name" or "name:parameter=value,parameter=value". The name and the parameters must be known, and
/// each parameter given at most once.
/// \throws ParameterError listing the known names or parameters
SurfaceSpecification parse_specification(std::string_view text);

/// Makes the surface of that name from the catalogue. Parameters that are not given have their defaults.
/// \throws ParameterError for an unknown name or parameter (the known ones are listed) or a value out of
/// range
AnySurface make_surface(const SurfaceSpecification& specification);
AnySurface make_surface(std::string_view text);

/// Every surface of the catalogue with default parameters, in the catalogue's order.
const std::vector<AnySurface>& all_surfaces();

}  // namespace darboux
