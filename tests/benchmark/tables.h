/// \file tables.h
/// The tables of docs/reports/evaluation.md.
#pragma once

#include <vector>

#include "groups.h"

namespace darboux::bench {

/// Writes all of them to standard output, from groups that were timed.
void write_tables(const std::vector<Group>& groups);

}  // namespace darboux::bench
