// Formula files: lines "name = expression". muParser compiles each expression to its bytecode, which is
// translated once into our own instructions.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <muParser.h>

#include <darboux/error.h>

#include "base/text.h"
#include "files.h"
#include "formula.h"
#include "formula_run.h"

namespace darboux::io::formula {
namespace {

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

// An occurrence of a name in an expression.
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

// muParser with our own functions, identified in its bytecode by the address of their entry in
// function_names.
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

// none for codes that do not combine the two values on top of the stack.
Operation binary_operation(mu::ECmdCode code) {
  constexpr std::pair<mu::ECmdCode, Operation> operations[] = {
      {mu::cmADD, Operation::add},    {mu::cmSUB, Operation::subtract},   {mu::cmMUL, Operation::multiply},
      {mu::cmDIV, Operation::divide}, {mu::cmPOW, Operation::power},      {mu::cmLT, Operation::less},
      {mu::cmGT, Operation::greater}, {mu::cmLE, Operation::not_greater}, {mu::cmGE, Operation::not_less},
      {mu::cmEQ, Operation::equal},   {mu::cmNEQ, Operation::unequal},    {mu::cmLAND, Operation::both},
      {mu::cmLOR, Operation::either}};
  for (const auto& [from, to] : operations)
    if (from == code) return to;
  return Operation::none;
}

class Reader {
 public:
  explicit Reader(const std::string& path) : path_(path) {}

  Program read() {
    read_lines(read_file(path_));
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
             "parameter " + definition.name + ": " + expected_got("a finite number", shortest(value)));
      program_.standard.push_back(value);
    }
    return std::move(program_);
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
      throw FileError(path_, expected_got("a formula of at most 1048576 bytes", std::to_string(text.size())));
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
                        expected_got("definitions of x, y and z by lines like " + name + " = cos(2*pi*u)",
                                     "none of " + name));
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
    if (!good) fail(number, expected_got("lines like x = a*cos(2*pi*u)", in_quotes(content)));
    constexpr std::size_t longest = 64;  // muParser throws beyond 100
    if (name.size() > longest)
      fail(number, expected_got("a name of at most 64 characters", std::to_string(name.size())));
    if (name == "u" || name == "v" || name == "pi" || find_function(name))
      fail(number, expected_got("a name other than u, v, pi and those of functions", name));
    if (const auto before = variables_.find(name); before != variables_.end())
      fail(number, name + ": " +
                       expected_got("one definition",
                                    "a second one (the first is in line " +
                                        std::to_string(at(before->second - first_definition).line) + ")"));
    // muParser would silently stop at a NUL.
    if (std::any_of(content.begin(), content.end(),
                    [](char c) { return static_cast<unsigned char>(c) < 32 && c != '\t'; }))
      fail(number, expected_got("text", in_quotes(content) + ", which holds a control character"));
    Definition d;
    d.name = name;
    d.line = number;
    const std::string_view expression = trimmed(content.substr(equals + 1));
    if (expression.empty())
      fail(number, expected_got("lines like " + name + " = 2", name + " without a value"));
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

  // Those that x, y and z need, each after its own dependencies; all others are checked too. Depth first,
  // with an explicit stack of open definitions, so that a long chain does not overflow the call stack.
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
          fail(at(next), expected_got("definitions that end at numbers, u and v",
                                      "one that needs itself: " + circle + at(next).name));
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
    // Whether the dependencies of an expression vary is known before it is translated.
    for (const int d : program_.order) translate(parser, d, places);
    for (std::size_t d = 0; d < program_.definitions.size(); ++d)
      if (at(static_cast<int>(d)).code.empty()) translate(parser, static_cast<int>(d), places);
  }

  // Compiles one expression to muParser's bytecode.
  void parse(Parser& parser, const Definition& definition) const {
    int results = 0;
    try {
      parser.SetExpr(definition.text);
      parser.Eval(results);
    } catch (const mu::ParserError& error) {
      fail(definition, syntax_error(definition, error));
    }
    if (results != 1)
      fail(definition, expected_got("one expression", in_quotes(definition.text) + ", which is " +
                                                          std::to_string(results) +
                                                          " expressions with commas between them"));
  }

  void translate(Parser& parser, int d, const std::vector<double>& places) {
    Definition& definition = at(d);
    parse(parser, definition);
    const mu::ParserByteCode& bytecode = parser.GetByteCode();
    const mu::SToken* token = bytecode.GetBase();
    std::vector<bool> varies,
        branches;  // of values on the stack; of first branches whose second one is open
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
      if (const Operation operation = binary_operation(t.Cmd); operation != Operation::none) {
        definition.code.push_back(binary(operation));
        continue;
      }
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
          fail(definition,
               expected_got("an expression of numbers",
                            in_quotes(definition.text) + ", which holds an assignment or a text"));
      }
      definition.code.push_back(instruction);
    }
    varies_[static_cast<std::size_t>(first_definition + d)] = varies.back();
  }

  // "unexpected token "*" at column 12", in columns of the file.
  std::string syntax_error(const Definition& d, const mu::ParserError& error) const {
    std::string what = error.GetMsg();
    if (error.GetCode() == mu::ecINTERNAL_ERROR)
      what = "Unexpected end of expression";  // a sign and nothing else
    for (const char* tail :
         {" found at position", " at position", " encountered at position", " at expression position"})
      if (const std::size_t end = what.find(tail); end != std::string::npos) what.resize(end);
    while (what.ends_with('.')) what.pop_back();
    const int position = std::clamp(error.GetPos(), 0, static_cast<int>(d.text.size()));
    return in_quotes(d.text) + " cannot be read at column " + std::to_string(d.column + position) + " (" +
           what + "), " + known_names();
  }

  const std::string& path_;
  Program program_;
  std::map<std::string, int> variables_{{"u", 0}, {"v", 1}, {"pi", 2}};
  std::vector<bool> varies_;  // each variable, with u and v
};

}  // namespace

Program read_program(const std::string& path) {
  return Reader(path).read();
}

}  // namespace darboux::io::formula
