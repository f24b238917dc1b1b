// SPDX-License-Identifier: MIT
#pragma once

#include <string>

#include "kissmap/formats/evaluation_report.hpp"

namespace kissmap {

/// The figures of a report as a table for people: a row a figure, a column a trajectory.
std::string evaluation_table(const EvaluationReport& report);

}  // namespace kissmap
