// SPDX-License-Identifier: MIT
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "formats/support.hpp"

namespace kissmap::test {

/// What a generator knows of a scan, or of all sweeps of a log that a rule of the reader cuts.
/// Words may be several, joined by |, where more than one is right.
struct ExpectedScan {
  bool refused = false;       ///< a file that holds no scan
  bool whole_log = false;     ///< points and times of all sweeps, one after the other
  std::int64_t stamp_ns = 0;  ///< of the scan; of a whole log what its times are relative to
  std::string instants;
  std::string compensations;
  std::string time_sources;
  DroppedReturns dropped;
  std::vector<Eigen::Vector3d> points;  ///< m, lidar frame
  std::vector<double> intensities;      ///< empty: the log has none
  std::vector<double> times;            ///< s since stamp_ns; empty: none, or any
};

struct ExpectedLog {
  std::filesystem::path path;
  std::string format;
  std::string topic;
  std::vector<ExpectedScan> scans;
};

/// The truth.txt of a folder, as described in generators/truth.py. Throws std::runtime_error.
std::vector<ExpectedLog> read_truth(const std::filesystem::path& folder);

/// How far from the truth the format's own resolution may put a value.
struct Resolution {
  double point = 0.0;  ///< m; 0: the same float32
  double time = 2e-8;  ///< s; float32 holds 0.1 s to 4e-9
};

/// Opens the log by its content alone and holds every scan against the truth.
void expect_log(const ExpectedLog& expected, const Resolution& resolution);

/// Holds scans against the truth of one log; words of "-" are not compared.
void expect_points(const ExpectedScan& expected,
                   const ExpectedScan& seen,
                   const Resolution& resolution);

/// What one of tests/formats/generators writes, in a folder that vanishes with the test.
class Generated {
 public:
  explicit Generated(const std::string& script);
  const std::filesystem::path& path() const { return dir_.path(); }
  const std::vector<ExpectedLog>& logs() const { return logs_; }

 private:
  TempDir dir_;
  std::vector<ExpectedLog> logs_;
};

/// Runs a Python program of tests/formats/generators, which has to succeed.
void run_generator(const std::string& arguments);

}  // namespace kissmap::test
