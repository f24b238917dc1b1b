// SPDX-License-Identifier: MIT
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include "support/program.hpp"

namespace kissmap {

/// A cloud as read_cloud.py, which shares nothing with our code, has read it.
struct CloudTable {
  std::vector<std::string> names;
  std::vector<std::vector<double>> rows;

  double at(std::size_t row, const std::string& name) const {
    const auto found = std::ranges::find(names, name);
    if (found == names.end()) throw std::out_of_range("no column " + name);
    return rows.at(row)[static_cast<std::size_t>(found - names.begin())];
  }
};

inline CloudTable read_cloud(const std::filesystem::path& path) {
  const ProgramResult result =
      run_program({KISSMAP_TEST_PYTHON, KISSMAP_TEST_SOURCES "/read_cloud.py", path});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  CloudTable table;
  std::istringstream lines(result.out);
  std::string line;
  std::getline(lines, line);
  std::istringstream words(line);
  for (std::string name; words >> name;) table.names.push_back(name);
  while (std::getline(lines, line)) {
    std::vector<double> row;
    const char* rest = line.c_str();
    for (std::size_t i = 0; i < table.names.size(); ++i) {
      char* end = nullptr;
      row.push_back(std::strtod(rest, &end));
      rest = end;
    }
    table.rows.push_back(row);
  }
  return table;
}

/// Name to values, as text.
inline std::map<std::string, std::string> las_header_of(const std::filesystem::path& path) {
  const ProgramResult result =
      run_program({KISSMAP_TEST_PYTHON, KISSMAP_TEST_SOURCES "/read_cloud.py", path, "header"});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  std::map<std::string, std::string> header;
  std::istringstream lines(result.out);
  for (std::string line; std::getline(lines, line);) {
    const std::size_t space = line.find(' ');
    header[line.substr(0, space)] = line.substr(space + 1);
  }
  return header;
}

}  // namespace kissmap
