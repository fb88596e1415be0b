/// \file configuration.h
/// Reads the options of a subcommand from a file.
#pragma once

#include <string>

#include <CLI/CLI.hpp>

namespace darboux {

/// Sets the options of a subcommand from a TOML file with one NAME = VALUE per line; `files` stands for the
/// FILES arguments. The command line takes precedence. Call it from the callback of the subcommand. \throws
/// FileError, also for an unknown option, a section, or a value that an option rejects
void read_configuration(CLI::App& sub, const std::string& path);

}  // namespace darboux
