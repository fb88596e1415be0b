/// \file formula.h
/// A formula file as a program: its definitions, compiled to instructions that can be evaluated for any
/// scalar type.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace darboux::io::formula {

/// The functions in expressions, including the unary signs.
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
/// The effect of an instruction on the stack.
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
  int index = 0;  // variable; jump distance; power: whether the exponent is constant
  Function function = Function::plus;
};

/// A line of the file: name = text # meaning.
struct Definition {
  std::string name, text, meaning;
  int line = 0, column = 1;  // of the expression, in the file
  std::vector<int> needs;    // variables
  std::vector<Instruction> code;
  bool parameter = false;  // defined by numbers alone
};

/// Variables are numbered: u, v, pi, then the definitions in file order.
inline constexpr int first_definition = 3;

/// A compiled file: evaluating the definitions in `order` gives x, y and z.
struct Program {
  std::vector<Definition> definitions;
  std::vector<int> parameters,
      order;  // of definitions: those that are parameters; those to be computed, in this order
  std::vector<double> standard;   // the parameters' values in the file
  std::array<int, 3> position{};  // the variables x, y, z
};

/// Reads a formula file. \throws FileError naming the file, the line and, for a syntax error, the column
Program read_program(const std::string& path);

}  // namespace darboux::io::formula
