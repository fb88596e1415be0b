/// \file configuration.h
/// The options of a subcommand from a file.
#pragma once

#include <string>

#include <CLI/CLI.hpp>

namespace darboux {

/// Gives a subcommand the options that a file holds, TOML's NAME = VALUE, a line each; `files` are its FILES.
/// The command line takes precedence. To be called from the subcommand's callback. \throws FileError,
/// also for a name that is no option, a section, a value that an option refuses
void read_configuration(CLI::App& sub, const std::string& path);

}  // namespace darboux
