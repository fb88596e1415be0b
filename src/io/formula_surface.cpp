// Surfaces from a user's formula. muParser turns each expression into its bytecode, which is translated once into
// instructions of our own; these run over every scalar, so that dual numbers give the partials.
#include <algorithm>
#include <array>
#include <cmath>
#include <concepts>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include <muParser.h>

#include <darboux/adaptors.h>
#include <darboux/error.h>
#include <darboux/io.h>

#include "../text.h"
#include "files.h"

namespace darboux {
namespace {

// ---- functions over any scalar ------------------------------------------------------------------------------------

enum class Function : std::uint8_t {
  minus,
  plus,
  sin,
  cos,
  tan,
  asin,
  acos,
  atan,
  sinh,
  cosh,
  tanh,
  asinh,
  acosh,
  atanh,
  sqrt,
  exp,
  log,
  abs,
  sign,
  sin_turns,
  cos_turns,
  atan2,
  pow,
  min,
  max
};
struct FunctionName {
  const char* name;
  Function function;
  int arguments;
};
constexpr std::array function_names{FunctionName{"sin", Function::sin, 1},
                                    FunctionName{"cos", Function::cos, 1},
                                    FunctionName{"tan", Function::tan, 1},
                                    FunctionName{"asin", Function::asin, 1},
                                    FunctionName{"acos", Function::acos, 1},
                                    FunctionName{"atan", Function::atan, 1},
                                    FunctionName{"atan2", Function::atan2, 2},
                                    FunctionName{"sinh", Function::sinh, 1},
                                    FunctionName{"cosh", Function::cosh, 1},
                                    FunctionName{"tanh", Function::tanh, 1},
                                    FunctionName{"asinh", Function::asinh, 1},
                                    FunctionName{"acosh", Function::acosh, 1},
                                    FunctionName{"atanh", Function::atanh, 1},
                                    FunctionName{"sqrt", Function::sqrt, 1},
                                    FunctionName{"exp", Function::exp, 1},
                                    FunctionName{"log", Function::log, 1},
                                    FunctionName{"ln", Function::log, 1},
                                    FunctionName{"pow", Function::pow, 2},
                                    FunctionName{"abs", Function::abs, 1},
                                    FunctionName{"sign", Function::sign, 1},
                                    FunctionName{"min", Function::min, 2},
                                    FunctionName{"max", Function::max, 2},
                                    FunctionName{"sin_turns", Function::sin_turns, 1},
                                    FunctionName{"cos_turns", Function::cos_turns, 1}};

template <class S>
constexpr bool is_dual = requires(const S& x) {
  x.derivative;
};

template <class S>
double to_double(const S& x) {
  if constexpr (is_dual<S>)
    return to_double(x.value);
  else
    return static_cast<double>(x);
}

template <class S>
Turn<S> sine_cosine(const S& x) {
  if constexpr (is_dual<S>) {
    const auto a = sine_cosine(x.value);
    return {S::chain(a.sin, a.cos, x), S::chain(a.cos, -a.sin, x)};
  } else if constexpr (std::floating_point<S>) {
    return {std::sin(x), std::cos(x)};
  } else {
    return sincos_half_turns(S(x / pi<S>()));
  }
}

template <class S>
S arctangent(const S& y, const S& x) {
  if constexpr (is_dual<S>) {
    const auto square = x.value * x.value + y.value * y.value;
    return S::chain(arctangent(y.value, x.value), x.value / square, y, -(y.value / square), x);
  } else if constexpr (std::floating_point<S>) {
    return std::atan2(y, x);
  } else {
    // The angle left over from that in double is below 1e-15: its tangent and one more term give it to 1e-75.
    const S coarse(std::atan2(to_double(y), to_double(x)));
    const auto [s, c] = sine_cosine(coarse);
    const S t = (y * c - x * s) / (x * c + y * s);
    return coarse + (t - t * t * t / S(3.0));
  }
}

// Wide real numbers have no inverse hyperbolic functions.
template <class S>
S inverse_hyperbolic(Function f, const S& x) {
  const S one = lift<S>(1.0);
  if constexpr (is_dual<S>) {
    const auto v = x.value;
    const auto i = lift<std::remove_cvref_t<decltype(v)>>(1.0);
    using std::sqrt;
    const auto slope = f == Function::asinh   ? i / sqrt(v * v + i)
                       : f == Function::acosh ? i / (sqrt(v - i) * sqrt(v + i))
                                              : i / ((i - v) * (i + v));
    return S::chain(inverse_hyperbolic(f, v), slope, x);
  } else if constexpr (std::floating_point<S>) {
    return f == Function::asinh ? std::asinh(x) : f == Function::acosh ? std::acosh(x) : std::atanh(x);
  } else if (f == Function::asinh) {
    const S a = abs(x), r = log(a + sqrt(a * a + one));
    return x < S(0.0) ? -r : r;
  } else if (f == Function::acosh) {
    return log(x + sqrt(x - one) * sqrt(x + one));
  } else {
    return log((one + x) / (one - x)) / S(2.0);
  }
}

template <class S>
S whole_power(S x, int n) {
  const S one = lift<S>(1.0);
  if (n < 0) return one / whole_power(x, -n);
  S result = one;
  for (bool first = true; n > 0; n /= 2) {
    if (n % 2 == 1) {
      result = first ? x : result * x;
      first = false;
    }
    if (n > 1) x = x * x;
  }
  return result;
}

// \param constant whether the exponent depends on neither u nor v
template <class S>
S power(const S& base, const S& exponent, bool constant) {
  if (constant) {
    const double n = to_double(exponent);
    constexpr double largest = 1024;
    if (std::fabs(n) <= largest && n == std::nearbyint(n) && (exponent == lift<S>(n) || base < lift<S>(0.0)))
      return whole_power(base, static_cast<int>(n));
  }
  if constexpr (is_dual<S>) {
    const auto &a = base.value, &b = exponent.value;
    using T = std::remove_cvref_t<decltype(a)>;
    using std::log;
    const T value = power(a, b, constant), slope = b * power(a, T(b - lift<T>(1.0)), constant);
    return constant ? S::chain(value, slope, base) : S::chain(value, slope, base, value * log(a), exponent);
  } else {
    using std::pow;
    return pow(base, exponent);
  }
}

template <class S>
S apply(Function f, const S& x) {
  using std::sqrt, std::exp, std::log, std::sinh, std::cosh, std::tanh, std::abs;
  const S zero = lift<S>(0.0), one = lift<S>(1.0);
  switch (f) {
    case Function::minus:
      return -x;
    case Function::sin:
      return sine_cosine(x).sin;
    case Function::cos:
      return sine_cosine(x).cos;
    case Function::tan: {
      const Turn<S> a = sine_cosine(x);
      return a.sin / a.cos;
    }
    case Function::asin:
      return arctangent(x, S(sqrt((one - x) * (one + x))));
    case Function::acos:
      return arctangent(S(sqrt((one - x) * (one + x))), x);
    case Function::atan:
      return arctangent(x, one);
    case Function::sinh:
      return sinh(x);
    case Function::cosh:
      return cosh(x);
    case Function::tanh:
      return tanh(x);
    case Function::asinh:
    case Function::acosh:
    case Function::atanh:
      return inverse_hyperbolic(f, x);
    case Function::sqrt:
      return sqrt(x);
    case Function::exp:
      return exp(x);
    case Function::log:
      return log(x);
    case Function::abs:
      return abs(x);
    case Function::sign:
      return x < zero ? -one : zero < x ? one : S(zero * x);  // NaN stays
    case Function::sin_turns:
      return sincos_turns(x).sin;
    case Function::cos_turns:
      return sincos_turns(x).cos;
    default:
      return x;  // plus
  }
}

// ---- instructions -------------------------------------------------------------------------------------------------

enum class Operation : std::uint8_t {
  number,
  variable,
  add,
  subtract,
  multiply,
  divide,
  power,
  less,
  greater,
  not_greater,
  not_less,
  equal,
  unequal,
  both,
  either,
  call1,
  call2,
  jump_if_zero,
  jump,
  none
};

struct Instruction {
  Operation operation;
  double number = 0;
  int index = 0;  // variable; how far to jump; power: whether the exponent is constant
  Function function = Function::plus;
};

struct Definition {
  std::string name, text, meaning;
  int line = 0, column = 1;  // of the expression, in the file
  std::vector<int> needs;    // variables
  std::vector<Instruction> code;
  bool parameter = false;
};

// Variables: u, v, pi, then the definitions in the file's order.
constexpr int first_definition = 3;

struct Program {
  std::vector<Definition> definitions;
  std::vector<int> parameters,
      order;  // of definitions: those that are parameters; those to be computed, in this order
  std::vector<double> standard;   // the parameters' values in the file
  std::array<int, 3> position{};  // the variables x, y, z
};

template <class S>
S execute(const std::vector<Instruction>& code, const std::vector<S>& variables, std::vector<S>& stack) {
  const S zero = lift<S>(0.0), one = lift<S>(1.0);
  stack.clear();
  const auto combine = [&](auto f) {
    const S y = stack.back();
    stack.pop_back();
    stack.back() = f(stack.back(), y);
  };
  const auto decide = [&](auto f) { combine([&](const S& x, const S& y) { return f(x, y) ? one : zero; }); };
  for (std::size_t at = 0; at < code.size(); ++at) {
    const Instruction& i = code[at];
    switch (i.operation) {
      case Operation::number:
        stack.push_back(lift<S>(i.number));
        break;
      case Operation::variable:
        stack.push_back(variables[static_cast<std::size_t>(i.index)]);
        break;
      case Operation::add:
        combine([](const S& x, const S& y) -> S { return x + y; });
        break;
      case Operation::subtract:
        combine([](const S& x, const S& y) -> S { return x - y; });
        break;
      case Operation::multiply:
        combine([](const S& x, const S& y) -> S { return x * y; });
        break;
      case Operation::divide:
        combine([](const S& x, const S& y) -> S { return x / y; });
        break;
      case Operation::power:
        combine([&](const S& x, const S& y) { return power(x, y, i.index != 0); });
        break;
      case Operation::less:
        decide([](const S& x, const S& y) { return x < y; });
        break;
      case Operation::greater:
        decide([](const S& x, const S& y) { return y < x; });
        break;
      case Operation::not_greater:
        decide([](const S& x, const S& y) { return x <= y; });
        break;
      case Operation::not_less:
        decide([](const S& x, const S& y) { return y <= x; });
        break;
      case Operation::equal:
        decide([](const S& x, const S& y) { return x == y; });
        break;
      case Operation::unequal:
        decide([](const S& x, const S& y) { return !(x == y); });
        break;
      case Operation::both:
        decide([&](const S& x, const S& y) { return !(x == zero) && !(y == zero); });
        break;
      case Operation::either:
        decide([&](const S& x, const S& y) { return !(x == zero) || !(y == zero); });
        break;
      case Operation::call1:
        stack.back() = apply(i.function, S(stack.back()));
        break;
      case Operation::call2:
        combine([&](const S& x, const S& y) -> S {
          switch (i.function) {
            case Function::atan2:
              return arctangent(x, y);
            case Function::pow:
              return power(x, y, i.index != 0);
            case Function::min:
              return y < x || !(y == y) ? y : x;  // NaN stays
            default:
              return x < y || !(y == y) ? y : x;
          }
        });
        break;
      case Operation::jump_if_zero: {
        const bool jump = stack.back() == zero;
        stack.pop_back();
        if (jump) at += static_cast<std::size_t>(i.index);
        break;
      }
      case Operation::jump:
        at += static_cast<std::size_t>(i.index);
        break;
      case Operation::none:
        break;
    }
  }
  return stack.back();
}

// ---- the surface --------------------------------------------------------------------------------------------------

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
    // Where there is no position there are no partials, though log has a slope left of zero by the rules.
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
      // What the formula bears nobody has said: random parameters stay within a factor of two.
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
        return std::string(p.name) + " = " + shortest(p.value) + ", permitted are finite numbers";
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

// ---- reading ------------------------------------------------------------------------------------------------------

bool begins_name(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_';
}
bool is_digit(char c) {
  return c >= '0' && c <= '9';
}
std::string_view trimmed(std::string_view text) {
  while (!text.empty() && static_cast<unsigned char>(text.back()) <= ' ') text.remove_suffix(1);
  while (!text.empty() && static_cast<unsigned char>(text.front()) <= ' ') text.remove_prefix(1);
  return text;
}
const FunctionName* find_function(std::string_view name) {
  for (const FunctionName& f : function_names)
    if (f.name == name) return &f;
  return nullptr;
}

// A name in an expression.
struct Mention {
  std::string name;
  int position;
};
std::vector<Mention> mentions(const std::string& text) {
  std::vector<Mention> result;
  std::size_t i = 0;
  while (i < text.size()) {
    const std::size_t start = i;
    if (is_digit(text[i]) || text[i] == '.') {
      while (i < text.size() && (is_digit(text[i]) || text[i] == '.')) ++i;
      if (i < text.size() && (text[i] == 'e' || text[i] == 'E')) {
        std::size_t k = i + 1;
        if (k < text.size() && (text[k] == '+' || text[k] == '-')) ++k;
        if (k < text.size() && is_digit(text[k])) i = k;
        while (i < text.size() && is_digit(text[i])) ++i;
      }
    } else if (begins_name(text[i])) {
      while (i < text.size() && (begins_name(text[i]) || is_digit(text[i]))) ++i;
      result.push_back({text.substr(start, i - start), static_cast<int>(start)});
    } else {
      ++i;
    }
  }
  return result;
}

// muParser with our own functions, told apart in its bytecode by the address of their entry in function_names.
class Parser : public mu::Parser {
 public:
  Parser() {
    ClearFun();
    ClearConst();
    ClearInfixOprt();
    EnableOptimizer(false);
    for (const FunctionName& f : function_names) {
      void* entry = const_cast<FunctionName*>(&f);
      if (f.arguments == 1)
        DefineFunUserData(f.name, one_argument, entry, false);
      else
        DefineFunUserData(f.name, two_arguments, entry, false);
    }
    DefineInfixOprt("-", minus, mu::prINFIX, false);
    DefineInfixOprt("+", plus, mu::prINFIX, false);
  }
  static double minus(double x) { return -x; }
  static double plus(double x) { return x; }

 private:
  static double one_argument(void*, double x) { return x; }
  static double two_arguments(void*, double x, double) { return x; }
};

class Reader {
 public:
  explicit Reader(const std::string& path) : path_(path) {}

  std::shared_ptr<const Program> read() {
    read_lines(io::read_file(path_));
    find_needs();
    find_order();
    translate_all();
    for (const int d : program_.parameters) {
      const Definition& definition = at(d);
      std::vector<double> variables(first_definition), stack;
      variables[2] = pi<double>();
      const double value = execute(definition.code, variables, stack);
      if (!std::isfinite(value))
        fail(definition,
             "parameter " + definition.name + " is " + shortest(value) + ", permitted are finite numbers");
      program_.standard.push_back(value);
    }
    return std::make_shared<const Program>(std::move(program_));
  }

 private:
  Definition& at(int d) { return program_.definitions[static_cast<std::size_t>(d)]; }

  [[noreturn]] void fail(int line, const std::string& message) const {
    throw FileError(path_ + ":" + std::to_string(line), message);
  }
  [[noreturn]] void fail(const Definition& d, const std::string& message) const { fail(d.line, message); }

  void read_lines(const std::string& text) {
    constexpr std::size_t largest = 1 << 20;
    if (text.size() > largest)
      throw FileError(
          path_, "has " + std::to_string(text.size()) + " bytes, permitted is a formula of at most 1048576");
    int line_number = 0;
    std::string_view rest = text;
    if (rest.starts_with("\xEF\xBB\xBF")) rest.remove_prefix(3);
    while (!rest.empty()) {
      ++line_number;
      const std::size_t end = rest.find('\n');
      read_line(rest.substr(0, end), line_number);
      rest = end == std::string_view::npos ? std::string_view() : rest.substr(end + 1);
    }
    for (std::size_t k = 0; k < 3; ++k) {
      const std::string name(1, "xyz"[k]);
      const auto found = variables_.find(name);
      if (found == variables_.end())
        throw FileError(path_,
                        name + " is not defined, permitted is a file that defines x, y and z by lines like " +
                            name + " = cos(2*pi*u)");
      program_.position[k] = found->second;
    }
  }

  void read_line(std::string_view line, int number) {
    const std::size_t hash = line.find('#');
    const std::string_view content = trimmed(line.substr(0, hash));
    if (content.empty()) return;
    const std::size_t equals = content.find('=');
    const std::string name(trimmed(content.substr(0, equals)));
    const bool good =
        equals != std::string_view::npos && !name.empty() && begins_name(name[0]) &&
        std::all_of(name.begin(), name.end(), [](char c) { return begins_name(c) || is_digit(c); });
    if (!good)
      fail(number, io::in_quotes(content) + " is no definition, permitted are lines like x = a*cos(2*pi*u)");
    if (name == "u" || name == "v" || name == "pi" || find_function(name))
      fail(
          number,
          name + " has a meaning of its own, permitted are other names than u, v, pi and those of functions");
    if (const auto before = variables_.find(name); before != variables_.end())
      fail(number, name + " is defined again, permitted is once (line " +
                       std::to_string(at(before->second - first_definition).line) + " does)");
    // muParser would stop at a NUL and be content.
    if (std::any_of(content.begin(), content.end(),
                    [](char c) { return static_cast<unsigned char>(c) < 32 && c != '\t'; }))
      fail(number, io::in_quotes(content) + " holds a control character, permitted is text");
    Definition d;
    d.name = name;
    d.line = number;
    const std::string_view expression = trimmed(content.substr(equals + 1));
    if (expression.empty()) fail(number, name + " has no value, permitted are lines like " + name + " = 2");
    d.text = expression;
    d.column = static_cast<int>(expression.data() - line.data()) + 1;
    if (hash != std::string_view::npos) d.meaning = one_line(std::string(trimmed(line.substr(hash + 1))));
    variables_[name] = first_definition + static_cast<int>(program_.definitions.size());
    program_.definitions.push_back(std::move(d));
  }

  std::string known_names() const {
    std::string text = "known are u, v, pi";
    for (const Definition& d : program_.definitions) text += ", " + d.name;
    text += " and the functions";
    const char* separator = " ";
    for (const FunctionName& f : function_names) {
      text += separator + std::string(f.name);
      separator = ", ";
    }
    return text;
  }

  void find_needs() {
    for (Definition& d : program_.definitions) {
      bool plain = d.name != "x" && d.name != "y" && d.name != "z";
      for (const Mention& mention : mentions(d.text)) {
        if (mention.name == "pi" || find_function(mention.name)) continue;
        const auto found = variables_.find(mention.name);
        if (found == variables_.end())
          fail(d, "unknown name '" + mention.name + "' at column " +
                      std::to_string(d.column + mention.position) + ", " + known_names());
        d.needs.push_back(found->second);
        plain = false;
      }
      d.parameter = plain;
      if (plain) program_.parameters.push_back(static_cast<int>(&d - program_.definitions.data()));
    }
  }

  // Those that x, y and z need, each after what it needs itself; all others are looked at too. Depth first, by a list of
  // open definitions, so that a long chain costs no stack.
  void find_order() {
    enum class State : std::uint8_t { fresh, open, done };
    std::vector<State> state(program_.definitions.size(), State::fresh);
    const auto visit = [&](int start, bool wanted) {
      std::vector<std::pair<int, std::size_t>> open;
      const auto enter = [&](int d) {
        state[static_cast<std::size_t>(d)] = State::open;
        open.emplace_back(d, 0);
      };
      if (state[static_cast<std::size_t>(start)] == State::fresh) enter(start);
      while (!open.empty()) {
        const int d = open.back().first;
        if (open.back().second == at(d).needs.size()) {
          state[static_cast<std::size_t>(d)] = State::done;
          if (wanted && !at(d).parameter) program_.order.push_back(d);
          open.pop_back();
          continue;
        }
        const int next = at(d).needs[open.back().second++] - first_definition;
        if (next < 0 || state[static_cast<std::size_t>(next)] == State::done) continue;
        if (state[static_cast<std::size_t>(next)] == State::open) {
          std::string circle;
          for (auto link =
                   std::find_if(open.begin(), open.end(), [&](const auto& o) { return o.first == next; });
               link != open.end(); ++link)
            circle += at(link->first).name + " -> ";
          fail(at(next), "a definition needs itself: " + circle + at(next).name +
                             ", permitted are definitions that end at numbers, u and v");
        }
        enter(next);
      }
    };
    for (const int k : program_.position) visit(k - first_definition, true);
    for (std::size_t d = 0; d < program_.definitions.size(); ++d) visit(static_cast<int>(d), false);
  }

  void translate_all() {
    Parser parser;
    std::vector<double> places(first_definition + program_.definitions.size(), 1.0);
    parser.DefineVar("u", &places[0]);
    parser.DefineVar("v", &places[1]);
    parser.DefineVar("pi", &places[2]);
    for (const auto& [name, k] : variables_)
      if (k >= first_definition) parser.DefineVar(name, &places[static_cast<std::size_t>(k)]);
    varies_.assign(places.size(), false);
    varies_[0] = varies_[1] = true;
    // What an expression needs is known to vary or not before it is translated.
    for (const int d : program_.order) translate(parser, d, places);
    for (std::size_t d = 0; d < program_.definitions.size(); ++d)
      if (at(static_cast<int>(d)).code.empty()) translate(parser, static_cast<int>(d), places);
  }

  void translate(Parser& parser, int d, const std::vector<double>& places) {
    Definition& definition = at(d);
    int results = 0;
    try {
      parser.SetExpr(definition.text);
      parser.Eval(results);
    } catch (const mu::ParserError& error) {
      fail(definition, syntax_error(definition, error));
    }
    if (results != 1)
      fail(definition, io::in_quotes(definition.text) + " is " + std::to_string(results) +
                           " expressions with commas between them, permitted is one");
    const mu::ParserByteCode& bytecode = parser.GetByteCode();
    const mu::SToken* token = bytecode.GetBase();
    std::vector<bool> varies,
        branches;  // of what lies on the stack; of first branches whose second one is open
    const auto take = [&varies] {
      const bool top = varies.back();
      varies.pop_back();
      return top;
    };
    for (std::size_t i = 0; i < bytecode.GetSize() && token[i].Cmd != mu::cmEND; ++i) {
      const mu::SToken& t = token[i];
      const auto binary = [&](Operation operation) {
        const bool right = take(), left = take();
        varies.push_back(left || right);
        return Instruction{operation, 0, right ? 0 : 1};
      };
      Instruction instruction{Operation::none};
      switch (t.Cmd) {
        case mu::cmVAL:
          instruction = {Operation::number, t.Val.data2};
          varies.push_back(false);
          break;
        case mu::cmVAR: {
          const auto k = t.Val.ptr - places.data();
          instruction = {Operation::variable, 0, static_cast<int>(k)};
          varies.push_back(varies_[static_cast<std::size_t>(k)]);
          break;
        }
        case mu::cmADD:
          instruction = binary(Operation::add);
          break;
        case mu::cmSUB:
          instruction = binary(Operation::subtract);
          break;
        case mu::cmMUL:
          instruction = binary(Operation::multiply);
          break;
        case mu::cmDIV:
          instruction = binary(Operation::divide);
          break;
        case mu::cmPOW:
          instruction = binary(Operation::power);
          break;
        case mu::cmLT:
          instruction = binary(Operation::less);
          break;
        case mu::cmGT:
          instruction = binary(Operation::greater);
          break;
        case mu::cmLE:
          instruction = binary(Operation::not_greater);
          break;
        case mu::cmGE:
          instruction = binary(Operation::not_less);
          break;
        case mu::cmEQ:
          instruction = binary(Operation::equal);
          break;
        case mu::cmNEQ:
          instruction = binary(Operation::unequal);
          break;
        case mu::cmLAND:
          instruction = binary(Operation::both);
          break;
        case mu::cmLOR:
          instruction = binary(Operation::either);
          break;
        case mu::cmIF:
          instruction = {Operation::jump_if_zero, 0, t.Oprt.offset};
          take();
          break;
        case mu::cmELSE:
          instruction = {Operation::jump, 0, t.Oprt.offset};
          branches.push_back(take());
          break;
        case mu::cmENDIF:
          if (branches.back()) varies.back() = true;
          branches.pop_back();
          break;
        case mu::cmFUNC: {
          const auto* entry = static_cast<const FunctionName*>(t.Fun.cb._pUserData);
          if (!entry) {
            const bool is_minus = t.Fun.cb._pRawFun == reinterpret_cast<mu::erased_fun_type>(&Parser::minus);
            instruction = {Operation::call1, 0, 0, is_minus ? Function::minus : Function::plus};
          } else if (entry->arguments == 1) {
            instruction = {Operation::call1, 0, 0, entry->function};
          } else {
            instruction = binary(Operation::call2);
            instruction.function = entry->function;
          }
          break;
        }
        default:
          fail(
              definition,
              io::in_quotes(definition.text) +
                  " is no value: it has an assignment or a text in it, permitted are expressions of numbers");
      }
      definition.code.push_back(instruction);
    }
    varies_[static_cast<std::size_t>(first_definition + d)] = varies.back();
  }

  // "unexpected token "*" at column 12", in our columns.
  std::string syntax_error(const Definition& d, const mu::ParserError& error) const {
    std::string what = error.GetMsg();
    if (error.GetCode() == mu::ecINTERNAL_ERROR)
      what = "Unexpected end of expression";  // a sign and nothing else
    for (const char* tail :
         {" found at position", " at position", " encountered at position", " at expression position"})
      if (const std::size_t end = what.find(tail); end != std::string::npos) what.resize(end);
    while (what.ends_with('.')) what.pop_back();
    const int position = std::clamp(error.GetPos(), 0, static_cast<int>(d.text.size()));
    return io::in_quotes(d.text) + " cannot be read at column " + std::to_string(d.column + position) + " (" +
           what + "), " + known_names();
  }

  const std::string& path_;
  Program program_;
  std::map<std::string, int> variables_{{"u", 0}, {"v", 1}, {"pi", 2}};
  std::vector<bool> varies_;  // each variable, with u and v
};

}  // namespace

AnySurface read_formula_surface(const std::string& path,
                                const std::vector<std::pair<std::string, double>>& parameters) {
  const std::shared_ptr<const Program> program = Reader(path).read();
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
