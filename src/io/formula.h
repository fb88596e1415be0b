/// \file formula.h
/// A formula file as a program: its definitions, translated into instructions that run over any scalar.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace darboux::io::formula {

/// What an expression may call; the signs are functions of one argument.
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
/// What an instruction does with the stack.
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

/// A line of the file: name = text # meaning.
struct Definition {
  std::string name, text, meaning;
  int line = 0, column = 1;  // of the expression, in the file
  std::vector<int> needs;    // variables
  std::vector<Instruction> code;
  bool parameter = false;  // defined by numbers alone
};

/// Variables are numbered u, v, pi, then the definitions in the file's order.
inline constexpr int first_definition = 3;

/// A file, ready to run: the definitions in `order`, one after another, give x, y and z.
struct Program {
  std::vector<Definition> definitions;
  std::vector<int> parameters,
      order;  // of definitions: those that are parameters; those to be computed, in this order
  std::vector<double> standard;   // the parameters' values in the file
  std::array<int, 3> position{};  // the variables x, y, z
};

/// Reads a formula file.
/// \throws FileError naming the file, the line and, in an expression that cannot be read, the column
Program read_program(const std::string& path);

}  // namespace darboux::io::formula
